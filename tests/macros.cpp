// Words that Windows, Qt, X11 and the C library of embedded systems define as macros do not occur in the headers: each is a
// syntax error here. Three do occur, and are put aside meanwhile: min and max of Windows, Status of X11. The standard library and
// Eigen come first, since what they can bear is theirs to say.
#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <algorithm>
#include <array>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string>
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
#define I a syntax error
#define B0 a syntax error
#define PI a syntax error
#define F_CPU a syntax error
#define min(a, b) (((a) < (b)) ? (a) : (b))
#define max(a, b) (((a) > (b)) ? (a) : (b))
#define Status int

#include "hmesh/hmesh.hpp"
#include "hmesh/paper.hpp"

// They are there again.
Status macros_are_back();
Status macros_are_back() { return max(min(3, 4), 1); }
static_assert(std::is_same_v<decltype(macros_are_back()), int>, "Status is the macro");
