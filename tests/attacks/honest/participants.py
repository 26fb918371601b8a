"""Announce nodes in the name of any participant, on the middleware's own discovery topic."""

import ctypes

from rclpy.serialization import serialize_message
from rmw_dds_common.msg import Gid, NodeEntitiesInfo, ParticipantEntitiesInfo

TOPIC = b'ros_discovery_info'
KIND = ParticipantEntitiesInfo.__class__


class Span(ctypes.Structure):
    _fields_ = [('seconds', ctypes.c_uint64), ('nanoseconds', ctypes.c_uint64)]


class Qos(ctypes.Structure):
    _fields_ = [
        ('history', ctypes.c_int),
        ('depth', ctypes.c_size_t),
        ('reliability', ctypes.c_int),
        ('durability', ctypes.c_int),
        ('deadline', Span),
        ('lifespan', Span),
        ('liveliness', ctypes.c_int),
        ('lease', Span),
        ('plain_names', ctypes.c_bool),
    ]


class Bytes(ctypes.Structure):
    _fields_ = [
        ('buffer', ctypes.c_char_p),
        ('length', ctypes.c_size_t),
        ('capacity', ctypes.c_size_t),
        ('allocator', ctypes.c_void_p * 5),
    ]


def channel(node):
    """Return a function that publishes on the middleware's own topic, whose name rclpy refuses."""
    rcl, rmw = ctypes.CDLL('librcl.so'), ctypes.CDLL('librmw_fastrtps_cpp.so')
    name = ctypes.pythonapi.PyCapsule_GetName
    name.restype, name.argtypes = ctypes.c_char_p, [ctypes.py_object]
    inside = ctypes.pythonapi.PyCapsule_GetPointer
    inside.restype, inside.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    rcl.rcl_node_get_rmw_handle.restype = ctypes.c_void_p
    rcl.rcl_node_get_rmw_handle.argtypes = [ctypes.c_void_p]
    rmw.rmw_create_publisher.restype = ctypes.c_void_p
    rmw.rmw_create_publisher.argtypes = (
        [ctypes.c_void_p] * 2 + [ctypes.c_char_p] + [ctypes.c_void_p] * 2
    )
    KIND.__import_type_support__()
    support = inside(KIND._TYPE_SUPPORT, name(KIND._TYPE_SUPPORT))
    qos = Qos(history=1, depth=100, reliability=1, durability=1, plain_names=True)
    options = (ctypes.c_uint64 * 2)(0, 0)
    publisher = rmw.rmw_create_publisher(
        rcl.rcl_node_get_rmw_handle(node.handle.pointer),
        support,
        TOPIC,
        ctypes.byref(qos),
        options,
    )

    def send(prefix, names):
        gid = Gid(data=[*prefix, 0, 0, 1, 0xC1])
        nodes = [NodeEntitiesInfo(node_namespace='/', node_name=name) for name in names]
        text = serialize_message(ParticipantEntitiesInfo(gid=gid, node_entities_info_seq=nodes))
        data = Bytes(text, len(text), len(text))
        rmw.rmw_publish_serialized_message(ctypes.c_void_p(publisher), ctypes.byref(data), None)

    return send
