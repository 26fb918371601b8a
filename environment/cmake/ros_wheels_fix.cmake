# The wheels were built in a container, and some exported targets still contain the path of its
# Python headers, below /opt/python. CMake refuses include directories that do not exist. The
# generated code does not need them (it finds Python and NumPy by itself), so this file removes them
# after all find_package() calls of the top-level project and before CMake checks them.
function(_ros_wheels_drop_missing_include_dirs)
  get_property(_targets DIRECTORY "${CMAKE_SOURCE_DIR}" PROPERTY IMPORTED_TARGETS)
  foreach(_target IN LISTS _targets)
    get_target_property(_dirs "${_target}" INTERFACE_INCLUDE_DIRECTORIES)
    if(_dirs)
      list(FILTER _dirs EXCLUDE REGEX "^/opt/python/")
      set_property(TARGET "${_target}" PROPERTY INTERFACE_INCLUDE_DIRECTORIES "${_dirs}")
    endif()
  endforeach()
endfunction()

if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
  cmake_language(DEFER CALL _ros_wheels_drop_missing_include_dirs)
endif()

# FindPython3.cmake in this folder saves about a hundred starts of Python per build.
list(PREPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}")

# A grader builds messages for Python programs, which use the generated C code but never the C++
# code. Without the C++ code, a build takes 40 % less CPU time. The list is filtered each time it
# grows, because rosidl_generate_interfaces() has no option for this. (The introspection type
# supports are needed: Fast DDS reads a type's members from them when a topic is created.)
if(DEFINED ENV{ROS2_COURSE_GRADED_BUILD})
  macro(_ros2_course_drop_cpp variable access)
    if("${access}" STREQUAL "MODIFIED_ACCESS")
      list(FILTER ${variable} EXCLUDE REGEX "_cpp:")
    endif()
  endmacro()
  variable_watch(AMENT_EXTENSIONS_rosidl_generate_idl_interfaces _ros2_course_drop_cpp)

  # GCC ignores a precompiled header made with other options, and parses the source instead.
  set(_ros2_course_headers "${CMAKE_CURRENT_LIST_DIR}/known")
  function(_ros2_course_include_precompiled targets language header)
    get_property(_targets DIRECTORY PROPERTY BUILDSYSTEM_TARGETS)
    list(FILTER _targets INCLUDE REGEX "${targets}")
    foreach(_target IN LISTS _targets)
      target_compile_options(${_target} PRIVATE
        "$<$<COMPILE_LANGUAGE:${language}>:SHELL:-include ${_ros2_course_headers}/${header}>")
    endforeach()
  endfunction()
  if(CMAKE_SOURCE_DIR STREQUAL CMAKE_CURRENT_SOURCE_DIR)
    if(EXISTS "${_ros2_course_headers}/fast_dds.hpp.gch")
      cmake_language(DEFER CALL _ros2_course_include_precompiled
        "__rosidl_typesupport_fastrtps_c$" CXX fast_dds.hpp)
    endif()
    if(EXISTS "${_ros2_course_headers}/python_api.h.gch")
      cmake_language(DEFER CALL _ros2_course_include_precompiled
        "__rosidl_generator_py$|_s__rosidl_typesupport_" C python_api.h)
    endif()
  endif()
endif()
