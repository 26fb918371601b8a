# Replacement for CMake's FindPython3: uses a known Python, or starts CMake's own search.
#
# CMake's search starts about ten interpreters (0.1 s each), which is most of CMake's time in a
# message package. The set-up builds one such package and keeps the result in known/python.cmake.
# A grader's builds use it; learners' builds search, as on their own machines.
if(DEFINED ENV{ROS2_COURSE_GRADED_BUILD} AND NOT DEFINED Python3_FIND_VERSION)
  set(_ros2_course_asked ${Python3_FIND_COMPONENTS})
  list(REMOVE_ITEM _ros2_course_asked Interpreter Development.Module NumPy)
  if(Python3_FIND_COMPONENTS AND NOT _ros2_course_asked)
    include("${CMAKE_CURRENT_LIST_DIR}/KnownPython3.cmake")
  endif()
  if(Python3_FOUND)
    return()
  endif()
endif()

# CMake caches its result, but treats the cache entry as one of an older version in every project
# with a compiled language: the entry has one field more than CMake expects, because the
# architecture is a list ("64;32"; CMake 3.31 to 4.4). A message package calls find_package() 13
# times, each call starts seven interpreters, and that took a third of the build. So a result that
# is known in this scope is used again; everything else is left to CMake.
if(Python3_Interpreter_FOUND AND TARGET Python3::Interpreter AND NOT DEFINED Python3_FIND_VERSION)
  set(_ros2_course_known TRUE)
  foreach(_ros2_course_part IN LISTS Python3_FIND_COMPONENTS)
    if(NOT Python3_${_ros2_course_part}_FOUND)
      set(_ros2_course_known FALSE)
    endif()
  endforeach()
  if(_ros2_course_known)
    set(Python3_FOUND TRUE)
    return()
  endif()
endif()
include("${CMAKE_ROOT}/Modules/FindPython3.cmake")
