"""
Tries: compute for ever before there is a node.

Stopped by: three seconds of processor time without a node
Deserves: 0
Ends: busy_before_node
Flag: busy_before_node
"""

while True:
    pass
