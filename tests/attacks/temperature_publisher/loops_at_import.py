"""
Tries: compute for ever before there is a node.

Stopped by: three seconds of processor time without a node
Deserves: 0
Flag: busy_before_node
"""

while True:
    pass
