# Writes the manual page of the program and of each of its commands, compressed.
# cmake -DSERVOMILL=PROGRAM -DGZIP=GZIP -DFOLDER=FOLDER -P manual_pages.cmake
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

function(write_page name)
  execute_process(COMMAND ${SERVOMILL} ${ARGN} --manual-page OUTPUT_FILE ${FOLDER}/${name}.1 COMMAND_ERROR_IS_FATAL ANY)
  execute_process(COMMAND ${GZIP} -9n ${FOLDER}/${name}.1 COMMAND_ERROR_IS_FATAL ANY)
endfunction()

execute_process(COMMAND ${SERVOMILL} --complete "" OUTPUT_VARIABLE lines COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[a-z][a-z-]*\t" commands "${lines}")
write_page(servomill)
foreach(line ${commands})
  string(STRIP "${line}" command)
  write_page(servomill-${command} ${command})
endforeach()
