/* The headers that the generated code of every message for Python includes; see fast_dds.hpp. NumPy's
 * headers are omitted: only some messages include them, and an additional header could add symbols. */
#include <Python.h>
#include <stdbool.h>
#include <stdint.h>
