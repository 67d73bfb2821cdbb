# The Debian packages: servomill has everything but the Python module, which is python3-servomill. Versions have a
# revision, so changelogs of packages stand next to ours.
set(documents ${CMAKE_CURRENT_BINARY_DIR}/documents)
configure_file(changelog.in ${documents}/changelog.Debian @ONLY)
add_custom_command(OUTPUT ${documents}/changelog.gz ${documents}/changelog.Debian.gz
  COMMAND ${GZIP} -9nc ${PROJECT_SOURCE_DIR}/CHANGELOG.md > ${documents}/changelog.gz
  COMMAND ${GZIP} -9nc ${documents}/changelog.Debian > ${documents}/changelog.Debian.gz
  DEPENDS ${PROJECT_SOURCE_DIR}/CHANGELOG.md ${documents}/changelog.Debian)
add_custom_target(servomill_documents ALL DEPENDS ${documents}/changelog.gz)

# servomill_documents(PACKAGE COMPONENT...): what Debian asks of every package.
function(servomill_documents package)
  install(FILES copyright ${documents}/changelog.gz ${documents}/changelog.Debian.gz
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package} ${ARGN})
  install(FILES lintian-overrides/${package} DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides ${ARGN})
endfunction()
servomill_documents(servomill)
if(SERVOMILL_PYTHON)
  servomill_documents(python3-servomill COMPONENT python)
endif()

# cpack stops where a part was left out of the build
set(parts_left_out)
foreach(part PAGE PYTHON)
  if(NOT SERVOMILL_${part})
    list(APPEND parts_left_out SERVOMILL_${part})
  endif()
endforeach()
set(CPACK_PROJECT_CONFIG_FILE ${CMAKE_CURRENT_BINARY_DIR}/complete.cmake)
configure_file(complete.cmake.in ${CPACK_PROJECT_CONFIG_FILE} @ONLY)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME servomill)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "")  # each package has its own
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "servomill authors <maintainers@servomill.invalid>")
set(CPACK_PACKAGE_VENDOR servomill)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_PROGRAM_PACKAGE_NAME servomill)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAM_PACKAGE_DEPENDS "python3:any")  # serves the page
set(CPACK_DEBIAN_PROGRAM_PACKAGE_SUGGESTS "python3-servomill, www-browser")
set(CPACK_DEBIAN_PROGRAM_DESCRIPTION "simulator of a five-axis milling machine and its servo loops
servomill runs G-code through a modelled numerical control on a modelled
machine with geometric errors, friction and heat, once for each strategy that
compensates these errors, and compares the cases point by point along the
programmed path. It also corrects programs, writes compensation tables,
identifies drives and geometric errors from measurements, and shows results
in a browser.")

get_directory_property(major DIRECTORY ../python DEFINITION PYTHON_VERSION_MAJOR)
get_directory_property(minor DIRECTORY ../python DEFINITION PYTHON_VERSION_MINOR)
math(EXPR next "0${minor} + 1")
set(python "python3 (>= ${major}.${minor}~), python3 (<< ${major}.${next})")  # of the compiled module
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-servomill)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SOURCE servomill)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "servomill (= ${PROJECT_VERSION}-1), ${python}, python3-numpy, python3-h5py")
set(CPACK_DEBIAN_PYTHON_PACKAGE_SUGGESTS "python3-xarray, python3-pandas, python3-matplotlib")
set(CPACK_DEBIAN_PYTHON_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_SOURCE_DIR}/python3/postinst ${CMAKE_CURRENT_SOURCE_DIR}/python3/prerm)
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "simulator of a five-axis milling machine (Python module)
servomill runs G-code through a modelled numerical control on a modelled
machine with geometric errors, friction and heat, once for each strategy that
compensates these errors.
.
This package contains the Python module: runs, sweeps, comparisons, frequency
responses, corrected programs and identification as functions, results as
arrays of NumPy and datasets of xarray, and strategies that are classes.")

include(CPack)
cpack_add_component_group(program)
cpack_add_component_group(python)
foreach(component Unspecified plugin page)
  cpack_add_component(${component} GROUP program)
endforeach()
cpack_add_component(python GROUP python)
