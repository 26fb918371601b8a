# The wheels were built in a container, and some of their exported targets still name its Python
# headers under /opt/python. CMake refuses include directories that do not exist. They are not
# needed (the generated code finds Python and NumPy by itself), so they are dropped after all
# find_package() calls of the top-level project and before CMake checks them.
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

# FindPython3.cmake beside this file keeps CMake from starting a hundred interpreters a build.
list(PREPEND CMAKE_MODULE_PATH "${CMAKE_CURRENT_LIST_DIR}")

# A grader builds messages for programs in Python, which use the C that is generated and never the
# C++; without it a build takes two fifths less of the processor. A list is filtered as it grows,
# because rosidl_generate_interfaces() has no way to ask for less. (Fast DDS asks the type supports
# for introspection what a type is made of, when a topic of it is opened: they are needed.)
if(DEFINED ENV{ROS2_COURSE_GRADED_BUILD})
  macro(_ros2_course_drop_cpp variable access)
    if("${access}" STREQUAL "MODIFIED_ACCESS")
      list(FILTER ${variable} EXCLUDE REGEX "_cpp:")
    endif()
  endmacro()
  variable_watch(AMENT_EXTENSIONS_rosidl_generate_idl_interfaces _ros2_course_drop_cpp)

  # GCC leaves a precompiled header alone that was made with other options, and reads the text.
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
