include(${CMAKE_CURRENT_LIST_DIR}/servomillTargets.cmake)

# servomill_add_plugin(NAME FILE...): a shared library NAME.so that `servomill --plugin` loads.
function(servomill_add_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE servomill::plugin)
  set_target_properties(${name} PROPERTIES PREFIX "" SUFFIX .so C_STANDARD 11 CXX_STANDARD 20 CXX_STANDARD_REQUIRED ON)
endfunction()
