# What find_package(Python3) comes to here: CMake's own search, or what the set-up's search has found.
#
# The search starts some ten interpreters (0.1 s each), which is most of what CMake does in a message
# package. The set-up builds one, and keeps the result in known/python.cmake. A grader's builds take
# it; learners' builds search, as they would at home.
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

# CMake keeps what it has found and then takes its own note for that of an older version, in every
# project with a compiled language: the note has an entry more than it expects, because the
# architecture is a list there ("64;32"; CMake 3.31 to 4.4). A message package asks thirteen times,
# each time seven interpreters are started, and that was a third of its build. So what this scope
# has found is taken as found; all else is CMake's own business.
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
