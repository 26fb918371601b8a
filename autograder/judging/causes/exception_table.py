"""
Exceptions of beginners that a pattern tells apart: what each means, and what to do.

The texts that are matched are those of Python 3.10 to 3.13 and of rclpy 7.1, as they come from
code that makes the mistake; lesson 08 makes many of them happen.
"""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Kind:
    """
    One way in which an exception is raised by a beginner.

    :param kind: name of its class; empty for any
    :param says: regular expression, searched in the message and, behind a line end, the line
    :param text: what is wrong; the place is put behind it, and groups of ``says`` into it
    :param try_this: the repair, with groups of ``says`` in it and names of the exam
    :param placed: whether the line of the traceback is the one to mend
    :param spins: whether it is even where the line only spins
    """

    kind: str
    says: str
    cause_id: str
    text: str
    try_this: str
    placed: bool = True
    spins: bool = False


KINDS = (
    Kind(
        'InvalidNodeNameException',
        '',
        'invalid_name',
        'A node name has a character that is not allowed, such as a dash or a slash',
        'Use letters, digits and underscores; a namespace is no part of the name.',
    ),
    Kind(
        'InvalidTopicNameException',
        '',
        'invalid_topic',
        'A topic name has a character that is not allowed, such as a space or a dash',
        'Use letters, digits and underscores, no digit in front, and no slash at the end.',
    ),
    Kind(
        'TypeError',
        "'NoneType' object is not callable",
        'called_not_passed',
        'A callback is None: the method was called where it should have been passed on',
        'Write the method without parentheses: create_timer(1.0, self.callback).',
        placed=False,  # it is found out by the executor, below a line that is innocent
    ),
    Kind(
        'TypeError',
        r'RcutilsLogger\.\w+\(\) takes',
        'log_arguments',
        'The logger takes one text, and gets several values',
        "Put them into one f-string: info(f'{value:.2f} degrees').",
    ),
    Kind(
        'TypeError',
        r'rclpy_logging_rcutils_log\(\): incompatible',
        'log_arguments',
        'The logger takes a text, and gets something else',
        "Make a text of it: info(f'{value}') or info(str(value)).",
    ),
    Kind(
        'ValueError',
        'Logger severity cannot be changed',
        'one_level_a_place',
        'One place in the code logs with two levels, and rclpy refuses the second',
        'Write two lines, one for each level, below if and else.',
    ),
    Kind(
        '',
        "has no attribute '_default_callback_group'",
        'no_super_init',
        'The class is used before its parent class is ready',
        "Call super().__init__('...') first of all in __init__().",
    ),
    Kind(
        'TypeError',
        r"Node\.__init__\(\) missing .*'node_name'",
        'no_super_init',
        'A node is made without a name',
        "Hand the name to the parent class: super().__init__('name') in __init__().",
    ),
    Kind(
        'RuntimeError',
        r'callback should be either be callable.*\n.*create_subscription\(.*,\s*(self\.\w+)\(\)',
        'called_not_passed',
        r'\1() is called where it should be passed on',
        r'Write the method without parentheses: \1.',
    ),
    Kind(
        'AttributeError',
        r"property '\w+' of '\w+' object has no setter",
        'reserved_name',
        'Every node already has something of that name',
        'Choose another name for your attribute, such as self.my_publisher.',
    ),
    Kind(
        'AttributeError',
        "has no attribute '_TYPE_SUPPORT'|'_CREATE_TYPE_SUPPORT'",
        'not_a_type',
        'What is given as the message type is no message class',
        "Import the class and pass it: create_publisher($type, '$topic', 10).",
    ),
    Kind(
        'AttributeError',
        r"'(?:function|method|builtin_function_or_method)' object has no attribute '(\w+)'"
        r'\n.*?\b(\w+)\.\1\b',
        'not_called',
        r'\2 is used without its parentheses',
        r'The parentheses are missing: \2().\1',
    ),
    Kind(
        'NotInitializedException',
        '',
        'no_init',
        'A node is made before ROS is ready',
        'Call rclpy.init(args=args) first of all in main().',
    ),
    Kind(
        'RuntimeError',
        r'Context\.init\(\) must only be called once',
        'init_twice',
        'rclpy.init() is called a second time',
        'Call it once, in main(), and not in the class.',
    ),
    Kind(
        'InvalidHandle',
        '',
        'destroyed_early',
        'Something is used after it was destroyed',
        'Call destroy_node() once, at the very end, in finally; destroy nothing that is still '
        'used.',
        placed=False,
    ),
    Kind(
        '',
        'generator already executing|Executor is already spinning',
        'nested_spin',
        'A callback spins the node that is being spun for it',
        'Never spin in a callback: return from it, and the next message finds the next call.',
    ),
    Kind(
        'ParameterNotDeclaredException',
        r'parameter\(s\): ([\w.]{1,60})',
        'not_declared',
        r'The node has not declared the parameter \1, which is used',
        r"Call self.declare_parameter('\1', ...) in __init__(), with the same spelling.",
    ),
    Kind(
        'ParameterNotDeclaredException',
        '',
        'not_declared',
        'A parameter is read that the node has not declared under that name',
        "Call self.declare_parameter('$parameter', ...) in __init__(), with the same spelling.",
    ),
    Kind(
        'InvalidParameterTypeException',  # its message shows the value that the grader has set
        '',
        'parameter_type',
        'A parameter gets a value of another type than its default has',
        'Give the default the type of the table: 1.0 is a float, 1 a whole number.',
    ),
    Kind(
        'InvalidQoSProfileException',
        '',
        'no_depth',
        'A QoSProfile is made without a depth',
        'Say how many messages it keeps: QoSProfile(depth=10).',
    ),
    Kind(
        'TypeError',
        'Expected QoSProfile or int, but received',
        'no_depth',
        'The depth of the queue is neither a whole number nor a QoSProfile',
        "Mind the order: create_publisher($type, '$topic', 10), and "
        "create_subscription($heard_type, '$heard_topic', self.callback, 10).",
    ),
    Kind(
        'TypeError',
        "got an unexpected keyword argument 'queue_size'",
        'queue_size',
        'queue_size, a name of ROS 1, is used',
        "In ROS 2 it is the third argument: create_publisher($type, '$topic', 10). In "
        'create_subscription() it is the fourth, behind the callback.',
    ),
    Kind(
        'TypeError',
        r'rclpy_resolve_name\(\): incompatible',
        'argument_order',
        'The name of the topic is no text',
        "First the type, then the name: create_publisher($type, '$topic', 10).",
    ),
    Kind(
        'TypeError',
        r"float\(\) argument must be .{0,60}not '(?:method|function)'\n.*create_timer",
        'argument_order',
        'create_timer() gets a method for its period',
        'First the period in seconds, then the method: create_timer(1.0, self.callback).',
    ),
    Kind(
        'TypeError',
        "cannot pickle 'rclpy",
        'deep_copy',
        'An object of ROS is copied with deepcopy(), which it does not allow',
        'Use copy.copy(), or make one of your own, such as QoSProfile(depth=10).',
    ),
    Kind(
        'TypeError',
        r": spin(?:_once)?\(\) missing \d required positional arguments?: .*'node'",
        'spins_no_node',
        'spin() is called without a node',
        'Say which node: rclpy.spin(node).',
    ),
    Kind(
        'AttributeError',
        r"'(?:\w+)' object has no attribute '(?:executor|subscriptions)'\n.*spin",
        'spins_no_node',
        'What spin() gets is no node',
        'Make the node first and pass it on: node = MyNode(), then rclpy.spin(node). Its class '
        'begins with class MyNode(Node).',
        spins=True,
    ),
    Kind(
        'AttributeError',
        r"'(?!NoneType\b)(\w+)' object has no attribute '(spin(?:_once|_until_future_complete)?)'",
        'spins_no_node',
        r'A \1 has no method \2(), and it is called',
        r'It is a function of rclpy, and gets the node in its parentheses: rclpy.\2(node).',
    ),
    Kind(
        'TypeError',
        r"'property' object is not iterable\n.*spin\w*\((\w+)",
        'class_for_object',
        r'spin() gets the class \1 in place of an object',
        r'Spin an object, \1(), not the class: node = \1(), then rclpy.spin(node).',
        spins=True,
    ),
    Kind(
        'AttributeError',
        "'property' object has no attribute",
        'class_for_object',
        'A class is used in place of an object',
        'Make the object with parentheses: message = $type(), not message = $type.',
    ),
    Kind(
        'TypeError',
        r"Expected <class '[\w.]+'>, got <class '[\w.]*\bMetaclass_(\w+)'",
        'not_a_message',
        r'publish() gets the class \1 in place of a message',
        r'Make one with \1(): message = \1(), not message = \1.',
    ),
    Kind(
        'TypeError',
        r"Expected <class '[\w.]+'>, got <class",
        'not_a_message',
        "publish() gets something that is no message of the publisher's type",
        'Put the value into a message: publish($type(...)).',
    ),
)
"""Exceptions of beginners, the first that fits."""
