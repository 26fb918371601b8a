"""
Tries: reach the internet, the host's own services and its abstract sockets.

Stopped by: a network namespace that has only a loopback interface and no sockets of the host
Deserves: 0
"""

import socket

for address in (('1.1.1.1', 53), ('8.8.8.8', 53), ('127.0.0.1', 22), ('127.0.0.1', 8888)):
    try:
        socket.create_connection(address, timeout=1)
    except OSError:
        continue
    print('REACHED', address)
try:
    socket.getaddrinfo('pypi.org', 443)
    print('REACHED name service')
except OSError:
    pass
for name in ('@/tmp/.X11-unix/X0', '/run/dbus/system_bus_socket', '/var/run/docker.sock'):
    with socket.socket(socket.AF_UNIX) as local:
        try:
            local.connect(name.replace('@', chr(0)))
        except OSError:
            continue
        print('REACHED', name)
