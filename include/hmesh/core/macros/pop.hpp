// hmesh - brings back the macros that push.hpp put aside.
#if defined(_MSC_VER) || defined(__GNUC__)
#pragma pop_macro("min")
#pragma pop_macro("max")
#pragma pop_macro("Status")
#pragma pop_macro("check")
#endif
