// hmesh - puts aside macros that have the names of things here, until pop.hpp: min and max of <windows.h>, Status of X11,
// check of Unreal Engine and of older macOS.
//
// No include guard: each header includes it last, and pop.hpp before it ends.
#if defined(_MSC_VER) || defined(__GNUC__)
#pragma push_macro("min")
#pragma push_macro("max")
#pragma push_macro("Status")
#pragma push_macro("check")
#endif
#undef min
#undef max
#undef Status
#undef check
