"""
Exceptions of beginners that a pattern tells apart: what each means, and what to do.

The texts that are matched are those of Python 3.10 to 3.13 and of rclpy 7.1, as they come from
code that makes the mistake; lesson 08 makes many of them happen.
"""

from __future__ import annotations

from typing import NamedTuple

from autograder.judging.text_table import rows


class Kind(NamedTuple):
    """
    One way in which an exception is raised by a beginner.

    :param says: regular expression, searched in the exception and, behind a line end, the line of
        code without its comments and texts
    :param text: what is wrong, with groups of ``says``
    :param try_this: the repair, with groups of ``says`` in it and names of the exam
    """

    cause_id: str
    says: str
    text: str
    try_this: str


_TABLE = r"""
not_started
^NotImplementedError\b
The exercise still raises NotImplementedError.
Replace that line with your own code and run the cell again.

assertion
^AssertionError\n
An assertion without a message fails.
Does a value have the wrong type, such as 0.3 for a Duration?

indentation
^((?:Indentation|Tab)Error.*)
The spaces at the beginning of a line are not right: \1
Indent by four spaces per level: the lines of a def, an if or a class are indented further than
  its first line.

notebook_line
^SyntaxError.*\n(?:(!) ?|(%)%?)[A-Za-z]\w*(?:\s|$)
Python cannot read the file: a line that begins with \1\2 works in notebooks only.
The cell of a node is a Python file: remove that line, and run it in a separate cell if you
  need it.

syntax
^(SyntaxError.*)
Python cannot read the file: \1
Correct that line; often a bracket, a colon or a quote is missing in the line above.

ros_1
No module named '((?:rospy|roscpp|rosbag|roslib)\b[\w.]{0,80})'
Your code imports \1, which ROS 2 does not have.
That is ROS 1; here it is rclpy: import rclpy, and from rclpy.node import Node.

import
No module named 'roslab\b
Your code imports roslab, which works only in the notebook, not in a node.
Leave it out here. A node file starts by itself: main() calls rclpy.init(), creates the node, and
  calls rclpy.spin(node).

invalid_name
^InvalidNodeNameException\b
A node name has a character that is not allowed, such as a dash or a slash.
Use letters, digits and underscores; a namespace is not part of the name.

invalid_topic
^InvalidTopicNameException\b
A topic name has a character that is not allowed, such as a space or a dash.
Use letters, digits and underscores, no digit in front, and no slash at the end.

called_not_passed
'NoneType' object is not callable
A callback is None: your code calls the method where it should pass it.
Write the method without parentheses: create_timer(1.0, self.callback).

log_arguments
RcutilsLogger\.\w+\(\) takes|rclpy_logging_rcutils_log\(\): incompatible
The logger takes one string, but gets something else.
Put all values into one f-string: info(f'{value:.2f} degrees').

one_level_a_place
Logger severity cannot be changed
This place in your code logs with two levels, but rclpy allows only one per place.
Write two lines, one for each level, below if and else.

no_super_init
has no attribute '_default_callback_group'
Your code uses the node before its parent class is ready.
Call super().__init__('...') first of all in __init__().

no_super_init
Node\.__init__\(\) missing .*'node_name'
Your code creates a node without a name.
Pass the name to the parent class: super().__init__('name') in __init__().

called_not_passed
callback should be either be callable.*\n.*create_subscription\(.*,\s*(self\.\w+)\(\)
Your code calls \1() where it should pass the method.
Write the method without parentheses: \1.

callback_arguments
callback should be either be callable
A callback has the wrong number of arguments.
A subscription passes the message, an event callback gets the event, a timer passes nothing;
  a method also has self first: def take(self, message).

no_depth
(create_(?:publisher|subscription))\(\) (missing \d+ required positional arguments?: [\w', ]+)
\1() gets too few arguments: \2
create_publisher($type, '$topic', 10): type, name, and the depth of the queue; a subscription
  takes its callback before the depth.

reserved_name
property '\w+' of '\w+' object has no setter
Every node already has something of that name.
Choose another name for your attribute, such as self.my_publisher.

not_a_type
has no attribute '_TYPE_SUPPORT'|'_CREATE_TYPE_SUPPORT'
The message type is not a message class.
Import the class and pass it: create_publisher($type, '$topic', 10).

not_called
'(?:function|method|builtin_function_or_method)' object has no attribute
  '(\w+)'\n.*?\b(\w+)\.\1\b
Your code uses \2 without its parentheses.
Add the parentheses: \2().\1

no_init
^NotInitializedException\b
Your code creates a node before rclpy.init().
Call rclpy.init(args=args) first of all in main().

init_twice
Context\.init\(\) must only be called once
Your program calls rclpy.init() a second time.
Call it once, in main(), and not in the class.

destroyed_early
^InvalidHandle\b
Your code uses something after it was destroyed.
Call destroy_node() once, at the very end, in finally; destroy nothing that you still use.

nested_spin
generator already executing|Executor is already spinning
A callback spins the node that is already being spun.
Never spin in a callback: return from it; the executor calls it again for the next message.

not_declared
parameter\(s\): ([\w.]{1,60})
Your code uses the parameter \1, which the node has not declared.
Call self.declare_parameter('\1', ...) in __init__(), with the same spelling.

not_declared
^ParameterNotDeclaredException\b
Your code uses a parameter that the node has not declared under that name.
Call self.declare_parameter('$parameter', ...) in __init__(), with the same spelling.

parameter_type
^InvalidParameterTypeException\b
A parameter gets a value whose type differs from that of its default.
Give the default, and a value in a file, the type of the table: 1.0 is a float, 1 an integer.

no_parameter_file
Couldn't parse params file.*Error opening YAML file
The parameter file is not installed where it is looked for.
In data_files of setup.py: ('share/' + package_name + '/config', ['config/NAME.yaml']).

parameter_file
Couldn't parse params file
ROS 2 cannot read the parameter file.
Each of its three levels has two more spaces: /**:, then ros__parameters:, then name: value.

no_depth
^InvalidQoSProfileException\b
Your code creates a QoSProfile without a depth.
Say how many messages it keeps: QoSProfile(depth=10).

no_depth
Expected QoSProfile or int, but received
The depth of the queue is neither an integer nor a QoSProfile.
Keep this order: create_publisher($type, '$topic', 10), and create_subscription($heard_type,
  '$heard_topic', self.callback, 10).

queue_size
got an unexpected keyword argument 'queue_size'
Your code uses queue_size, a name of ROS 1.
In ROS 2 it is the third argument: create_publisher($type, '$topic', 10). In
  create_subscription() it is the fourth, after the callback.

argument_order
rclpy_resolve_name\(\): incompatible
The name of the topic is not a string.
Pass the type first, then the name: create_publisher($type, '$topic', 10).

argument_order
float\(\) argument must be .{0,60}not '(?:method|function)'\n.*create_timer
create_timer() gets a method for its period.
Pass the period in seconds first, then the method: create_timer(1.0, self.callback).

deep_copy
cannot pickle 'rclpy
Your code copies an object of ROS with deepcopy(), which ROS does not allow.
Use copy.copy(), or create a new object, such as QoSProfile(depth=10).

local_name
^UnboundLocalError: .*local variable '(\w{1,60})'
This def uses \1 before it gives \1 a value, and a name that a def assigns to is its own.
Give \1 a value in every branch above that line. To change a value from outside the def, keep it as
  self.\1 everywhere.

spins_no_node
: spin(?:_once)?\(\) missing \d required positional arguments?: .*'node'
Your code calls spin() without a node.
Pass the node: rclpy.spin(node).

spins_no_node
'(?:\w+)' object has no attribute '(?:executor|subscriptions)'\n.*spin
The argument of spin() is not a node.
Create the node first and pass it: node = MyNode(), then rclpy.spin(node). Its class begins with
  class MyNode(Node).

spins_no_node
'(?!NoneType\b)(\w+)' object has no attribute '(spin(?:_once|_until_future_complete)?)'
Your code calls \2(), a method that \1 does not have.
It is a function of rclpy: rclpy.\2(node).

class_for_object
'property' object is not iterable\n.*spin\w*\((\w+)
spin() gets the class \1 instead of an object.
Spin an object, \1(), not the class: node = \1(), then rclpy.spin(node).

class_for_object
'property' object has no attribute
Your code uses a class instead of an object.
Create the object with parentheses: message = $type(), not message = $type.

not_a_message
Expected <class '[\w.]+'>, got <class '[\w.]*\bMetaclass_(\w+)'
publish() gets the class \1 instead of a message.
Create one with \1(): message = \1(), not message = \1.

not_a_message
Expected <class '[\w.]+'>, got <class
publish() gets something that is not a message of the publisher's type.
Put the value into a message: publish($type(...)).
"""

KINDS = tuple(Kind(*row) for row in rows(_TABLE))
"""Exceptions of beginners, the first that fits."""
