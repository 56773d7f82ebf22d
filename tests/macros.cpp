// Words that Windows, Qt, X11, game engines and C libraries define as macros occur in no header: each is a syntax error here.
// The standard library and Eigen come first, since what they can bear is theirs to say.
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <initializer_list>
#include <iterator>
#include <limits>
#include <new>
#include <numeric>
#include <optional>
#include <queue>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#define near a syntax error
#define far a syntax error
#define small a syntax error
#define hyper a syntax error
#define interface a syntax error
#define pascal a syntax error
#define cdecl a syntax error
#define IN a syntax error
#define OUT a syntax error
#define OPTIONAL a syntax error
#define ERROR a syntax error
#define DELETE a syntax error
#define DIFFERENCE a syntax error
#define RGB a syntax error
#define TRANSPARENT a syntax error
#define CreateWindow a syntax error
#define GetObject a syntax error
#define slots a syntax error
#define signals a syntax error
#define emit a syntax error
#define foreach a syntax error
#define forever a syntax error
#define Bool a syntax error
#define None a syntax error
#define Always a syntax error
#define Success a syntax error
#define Complex a syntax error
#define True a syntax error
#define False a syntax error
#define Above a syntax error
#define Below a syntax error
#define Convex a syntax error
#define Nonconvex a syntax error
#define Unsorted a syntax error
#define I a syntax error
#define complex a syntax error
#define major a syntax error
#define minor a syntax error
#define unix a syntax error
#define linux a syntax error
#define verify a syntax error
#define ensure a syntax error
#define require a syntax error
#define TEXT a syntax error
#define nil a syntax error
#define B0 a syntax error
#define PI a syntax error
#define F_CPU a syntax error

// These are put aside by each header, and given back.
#define min(a, b) a syntax error
#define max(a, b) a syntax error
#define Status a syntax error
#define check(expression) a syntax error

#include "all_headers.hpp"

#if !defined(min) || !defined(max) || !defined(Status) || !defined(check)
#error "a macro of the user's is gone"
#endif
