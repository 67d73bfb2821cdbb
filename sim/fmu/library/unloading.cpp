// The library contains its own C++ run time, whose reserve for exceptions (72 kB) would stay behind
// each time an importer unloads it.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): names of libstdc++
namespace __gnu_cxx {
void __freeres();
}  // namespace __gnu_cxx
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

namespace servomill::sim::fmu {
namespace {

__attribute__((destructor)) void release_reserve() { __gnu_cxx::__freeres(); }

}  // namespace
}  // namespace servomill::sim::fmu
