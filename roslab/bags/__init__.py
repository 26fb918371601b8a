"""
Bags: recorded topics in MCAP files, as ``ros2 bag`` writes them.

Notebooks and the ``ros2 bag`` command share these modules, so they import neither IPython nor the
session of a kernel.
"""
