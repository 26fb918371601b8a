/* What the generated code of every message for Python includes; see fast_dds.hpp. */
#define NPY_NO_DEPRECATED_API NPY_1_7_API_VERSION
#include <Python.h>
#include <stdbool.h>
#include <stdint.h>

#include "numpy/ndarrayobject.h"
