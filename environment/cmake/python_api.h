/* What the generated code of every message for Python includes; see fast_dds.hpp. Without numpy: only
 * some of it includes that, and a header that is not asked for could add symbols. */
#include <Python.h>
#include <stdbool.h>
#include <stdint.h>
