// The library contains its own C++ run time, whose reserve for exceptions (72 kB) would stay behind
// each time an importer unloads it.
namespace __gnu_cxx {
void __freeres();
}  // namespace __gnu_cxx

namespace servomill::sim::fmu {
namespace {

__attribute__((destructor)) void release_reserve() { __gnu_cxx::__freeres(); }

}  // namespace
}  // namespace servomill::sim::fmu
