"""
Tries: compute forever before it creates a node.

Stopped by: three seconds of processor time without a node
Deserves: 0
Ends: busy_before_node
Flag: busy_before_node
"""

while True:
    pass
