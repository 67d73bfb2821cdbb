# Writes OUT, the source of build_identity(), from a checksum of the sources of ROOMS below SOURCE_DIR:
# cmake -DSOURCE_DIR=... -DROOMS=plant,sim -DVERSION=... -DOUT=... -P build_identity.cmake
string(REPLACE "," ";" rooms "${ROOMS}")
set(patterns ${SOURCE_DIR}/CMakeLists.txt)
foreach(room ${rooms})
  list(APPEND patterns ${SOURCE_DIR}/${room}/*.cpp ${SOURCE_DIR}/${room}/*.h ${SOURCE_DIR}/${room}/CMakeLists.txt)
endforeach()
file(GLOB_RECURSE sources RELATIVE ${SOURCE_DIR} ${patterns})
list(SORT sources)
set(all "")
foreach(source ${sources})
  file(SHA256 ${SOURCE_DIR}/${source} sum)
  string(APPEND all "${source} ${sum}\n")
endforeach()
string(SHA256 sum "${all}")
string(SUBSTRING ${sum} 0 12 sum)
file(WRITE ${OUT} "#include \"sim/run/build_identity.h\"

namespace servomill::sim::run {

std::string_view build_identity() { return \"${VERSION}+${sum}\"; }

}  // namespace servomill::sim::run
")
