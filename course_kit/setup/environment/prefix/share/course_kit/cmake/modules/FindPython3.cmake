# Each ament package looks for Python again, and each time CMake's own module starts it some ten times. What a project
# has found once is not looked for again.

set(_course_kit_looks FALSE)
foreach(_course_kit_part IN LISTS Python3_FIND_COMPONENTS)
  if(NOT Python3_${_course_kit_part}_FOUND)
    set(_course_kit_looks TRUE)
  endif()
endforeach()
if(_course_kit_looks OR NOT Python3_Interpreter_FOUND OR Python3_FIND_VERSION_COMPLETE)
  include("${CMAKE_ROOT}/Modules/FindPython3.cmake")
endif()
