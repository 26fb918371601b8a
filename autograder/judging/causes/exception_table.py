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
    :param text: what is wrong, with groups of ``says``; ``{where}`` is the place in the cell if
        that line is the one to mend, ``{place}`` even where it only spins
    :param try_this: the repair, with groups of ``says`` in it and names of the exam
    """

    cause_id: str
    says: str
    text: str
    try_this: str


_TABLE = r"""
not_started
^NotImplementedError\b
The exercise still raises NotImplementedError{where}.
Replace that line with your own code and run the cell again.

assertion
^AssertionError\n
An assertion fails{where}, and says no more.
Is there a value of a type that does not belong there, such as 0.3 for a Duration?

indentation
^((?:Indentation|Tab)Error.*)
The spaces at the beginning of a line are not right{where}: \1
Indent by four spaces a level: what belongs to a def, an if or a class is indented further than
  it.

notebook_line
^SyntaxError.*\n(?:(!) ?|(%)%?)[A-Za-z]\w*(?:\s|$)
Python cannot read the file{where}: a line that begins with \1\2 works in notebooks only.
The cell of a node is a Python file: take that line out, and run it in a cell of its own if you
  need it.

syntax
^(SyntaxError.*)
Python cannot read the file{where}: \1
Correct that line; often a bracket, a colon or a quote is missing in the line above.

ros_1
No module named '((?:rospy|roscpp|rosbag|roslib)\b[\w.]{0,80})'
\1 is imported{where}, and ROS 2 has no such module.
That is ROS 1; here it is rclpy: import rclpy, and from rclpy.node import Node.

import
No module named 'roslab\b
roslab is imported{where}; it belongs to the notebook, and is not there for a node.
Leave it out here. A node file starts by itself: main() calls rclpy.init(), makes the node, and
  calls rclpy.spin(node).

invalid_name
^InvalidNodeNameException\b
A node name has a character that is not allowed, such as a dash or a slash{where}.
Use letters, digits and underscores; a namespace is no part of the name.

invalid_topic
^InvalidTopicNameException\b
A topic name has a character that is not allowed, such as a space or a dash{where}.
Use letters, digits and underscores, no digit in front, and no slash at the end.

called_not_passed
'NoneType' object is not callable
A callback is None: the method was called where it should have been passed on.
Write the method without parentheses: create_timer(1.0, self.callback).

log_arguments
RcutilsLogger\.\w+\(\) takes
The logger takes one text, and gets several values{where}.
Put them into one f-string: info(f'{value:.2f} degrees').

log_arguments
rclpy_logging_rcutils_log\(\): incompatible
The logger takes a text, and gets something else{where}.
Make a text of it: info(f'{value}') or info(str(value)).

one_level_a_place
Logger severity cannot be changed
One place in the code logs with two levels, and rclpy refuses the second{where}.
Write two lines, one for each level, below if and else.

no_super_init
has no attribute '_default_callback_group'
The class is used before its parent class is ready{where}.
Call super().__init__('...') first of all in __init__().

no_super_init
Node\.__init__\(\) missing .*'node_name'
A node is made without a name{where}.
Hand the name to the parent class: super().__init__('name') in __init__().

called_not_passed
callback should be either be callable.*\n.*create_subscription\(.*,\s*(self\.\w+)\(\)
\1() is called where it should be passed on{where}.
Write the method without parentheses: \1.

callback_arguments
callback should be either be callable
A callback gets another number of arguments than its def line has{where}.
A subscription hands over the message, an event callback gets the event, a timer gives nothing;
  and a method has self first: def take(self, message).

no_depth
(create_(?:publisher|subscription))\(\) (missing \d+ required positional arguments?: [\w', ]+)
\1() gets too few arguments{where}: \2
create_publisher($type, '$topic', 10): type, name, and the depth of the queue; a subscription
  takes its callback before the depth.

reserved_name
property '\w+' of '\w+' object has no setter
Every node already has something of that name{where}.
Choose another name for your attribute, such as self.my_publisher.

not_a_type
has no attribute '_TYPE_SUPPORT'|'_CREATE_TYPE_SUPPORT'
What is given as the message type is no message class{where}.
Import the class and pass it: create_publisher($type, '$topic', 10).

not_called
'(?:function|method|builtin_function_or_method)' object has no attribute
  '(\w+)'\n.*?\b(\w+)\.\1\b
\2 is used without its parentheses{where}.
The parentheses are missing: \2().\1

no_init
^NotInitializedException\b
A node is made before ROS is ready{where}.
Call rclpy.init(args=args) first of all in main().

init_twice
Context\.init\(\) must only be called once
rclpy.init() is called a second time{where}.
Call it once, in main(), and not in the class.

destroyed_early
^InvalidHandle\b
Something is used after it was destroyed.
Call destroy_node() once, at the very end, in finally; destroy nothing that is still used.

nested_spin
generator already executing|Executor is already spinning
A callback spins the node that is being spun for it{where}.
Never spin in a callback: return from it, and the next message finds the next call.

not_declared
parameter\(s\): ([\w.]{1,60})
The node has not declared the parameter \1, which is used{where}.
Call self.declare_parameter('\1', ...) in __init__(), with the same spelling.

not_declared
^ParameterNotDeclaredException\b
A parameter is read that the node has not declared under that name{where}.
Call self.declare_parameter('$parameter', ...) in __init__(), with the same spelling.

parameter_type
^InvalidParameterTypeException\b
A parameter gets a value whose type differs from that of its default{where}.
Give the default, and a value in a file, the type of the table: 1.0 is a float, 1 a whole number.

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
A QoSProfile is made without a depth{where}.
Say how many messages it keeps: QoSProfile(depth=10).

no_depth
Expected QoSProfile or int, but received
The depth of the queue is neither a whole number nor a QoSProfile{where}.
Mind the order: create_publisher($type, '$topic', 10), and create_subscription($heard_type,
  '$heard_topic', self.callback, 10).

queue_size
got an unexpected keyword argument 'queue_size'
queue_size, a name of ROS 1, is used{where}.
In ROS 2 it is the third argument: create_publisher($type, '$topic', 10). In
  create_subscription() it is the fourth, behind the callback.

argument_order
rclpy_resolve_name\(\): incompatible
The name of the topic is not a string{where}.
First the type, then the name: create_publisher($type, '$topic', 10).

argument_order
float\(\) argument must be .{0,60}not '(?:method|function)'\n.*create_timer
create_timer() gets a method for its period{where}.
First the period in seconds, then the method: create_timer(1.0, self.callback).

deep_copy
cannot pickle 'rclpy
An object of ROS is copied with deepcopy(), which it does not allow{where}.
Use copy.copy(), or make one of your own, such as QoSProfile(depth=10).

spins_no_node
: spin(?:_once)?\(\) missing \d required positional arguments?: .*'node'
spin() is called without a node{where}.
Say which node: rclpy.spin(node).

spins_no_node
'(?:\w+)' object has no attribute '(?:executor|subscriptions)'\n.*spin
The argument of spin() is not a node{place}.
Make the node first and pass it on: node = MyNode(), then rclpy.spin(node). Its class begins with
  class MyNode(Node).

spins_no_node
'(?!NoneType\b)(\w+)' object has no attribute '(spin(?:_once|_until_future_complete)?)'
A \1 has no method \2(), and it is called{where}.
It is a function of rclpy, and gets the node in its parentheses: rclpy.\2(node).

class_for_object
'property' object is not iterable\n.*spin\w*\((\w+)
spin() gets the class \1 in place of an object{place}.
Spin an object, \1(), not the class: node = \1(), then rclpy.spin(node).

class_for_object
'property' object has no attribute
A class is used in place of an object{where}.
Make the object with parentheses: message = $type(), not message = $type.

not_a_message
Expected <class '[\w.]+'>, got <class '[\w.]*\bMetaclass_(\w+)'
publish() gets the class \1 in place of a message{where}.
Make one with \1(): message = \1(), not message = \1.

not_a_message
Expected <class '[\w.]+'>, got <class
publish() gets something that is no message of the publisher's type{where}.
Put the value into a message: publish($type(...)).
"""

KINDS = tuple(Kind(*row) for row in rows(_TABLE))
"""Exceptions of beginners, the first that fits."""
