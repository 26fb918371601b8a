"""
Read submissions: notebooks, cells, packages and code.

In all modules, ``release`` is the notebook that students received, and ``where`` is the name of
the submitted file in messages.
"""
