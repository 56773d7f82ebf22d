/// \file
/// Attributes of functions: inlined always, inlined never, seldom run.
#ifndef HMESH_CORE_COMPILER_HPP
#define HMESH_CORE_COMPILER_HPP

/// Inlined even where a compiler thinks the function too large: for what innermost loops call. Not without optimisation, where
/// it would only make compiling slower, up to twice.
#if defined(__GNUC__) && defined(__OPTIMIZE__)
#define HMESH_ALWAYS_INLINE inline __attribute__((always_inline))
#elif defined(_MSC_VER)
#define HMESH_ALWAYS_INLINE __forceinline
#else
#define HMESH_ALWAYS_INLINE inline
#endif

/// Never inlined or cloned: two copies may contract a*b+c differently and round differently, and each costs compile time.
#if defined(__clang__)
#define HMESH_NEVER_INLINE __attribute__((noinline))
#elif defined(__GNUC__)
#define HMESH_NEVER_INLINE __attribute__((noinline, noclone))
#elif defined(_MSC_VER)
#define HMESH_NEVER_INLINE __declspec(noinline)
#else
#define HMESH_NEVER_INLINE
#endif

/// For functions that run once a mesh, tile or stage, never once a vertex: compiled for size, which takes a tenth off the compile
/// time of a call of mesh_image() and adds less than 0.5 % to its run time. To clang++ `cold` alone means no size.
#if defined(__clang__)
#define HMESH_COLD __attribute__((cold, minsize))
#elif defined(__GNUC__)
#define HMESH_COLD __attribute__((cold))
#else
#define HMESH_COLD
#endif

/// For functions that run once a patch in each phase, or on all of a mesh between phases, and for what these call: a tenth of the
/// time of a draft of many megapixels. Compiled for size where a page has to load them. Elsewhere nothing that they call for
/// certain may be HMESH_COLD, an array's destructor included: to GCC that makes the caller cold.
#if defined(__wasm__)
#define HMESH_PATCHWISE HMESH_COLD
#else
#define HMESH_PATCHWISE HMESH_NEVER_INLINE
#endif

/// Asks for the line of memory at an address, which is soon to be read, where there is a word for it.
#if defined(__GNUC__) && !defined(__wasm__)
#define HMESH_PREFETCH(address) __builtin_prefetch(address)
#else
#define HMESH_PREFETCH(address) static_cast<void>(address)
#endif

#endif  // HMESH_CORE_COMPILER_HPP
