// hmesh - puts aside macros that have the names of things here, until pop.hpp: min and max of <windows.h>, Status of X11.
//
// No include guard: each header includes it last, and pop.hpp before it ends.
#if defined(_MSC_VER) || defined(__GNUC__)
#pragma push_macro("min")
#pragma push_macro("max")
#pragma push_macro("Status")
#endif
#undef min
#undef max
#undef Status
