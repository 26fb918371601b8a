# CMake keeps what find_package(Python3) has found and then takes its own note for that of an older
# version, in every project with a compiled language: the note has an entry more than it expects,
# because the architecture is a list there ("64;32"; CMake 3.31 to 4.4). A message package asks
# thirteen times, each time seven interpreters are started, and that was a third of its build. So
# what this scope has found is taken as found; all else is CMake's own business.
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
