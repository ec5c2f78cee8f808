// OSMesa (22.3) keeps some 160 bytes of every context it destroys, and LLVM some of its start-up: not our
// leaks.
extern "C" const char* __lsan_default_suppressions();  // NOLINT: the name is the sanitizer's
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa\nleak:libLLVM\n"; }
// Programs whose output is looked at stay silent about it.
extern "C" const char* __lsan_default_options();  // NOLINT
extern "C" const char* __lsan_default_options() { return "print_suppressions=0"; }
