/// \file
/// FunctionRef: a non-owning reference to any callable, so that what takes a callback is compiled once.
///
/// Two pointers, nothing allocated; a call costs an indirect jump, some 2 ns. Like C++26's std::function_ref, except that it
/// may refer to nothing, and that the callable must return exactly the type asked for: a count where a bool is wanted is a
/// mistake.
#ifndef HMESH_CORE_FUNCTION_REF_HPP
#define HMESH_CORE_FUNCTION_REF_HPP

#include <type_traits>
#include <utility>

#include "hmesh/core/macros/push.hpp"

namespace hmesh {
namespace detail {

/// Whether a class of objects can be called with these arguments and returns this, or anything for void. By the language alone:
/// the standard library's traits are many templates for each of the hundred lambdas in a call of mesh_image().
template <class Void, class Callable, class Result, class... Arguments>
inline constexpr bool is_callback = false;
template <class Callable, class Result, class... Arguments>
inline constexpr bool
    is_callback<std::void_t<decltype(std::declval<Callable&>()(std::declval<Arguments>()...))>, Callable, Result, Arguments...> =
        std::is_class_v<Callable> &&
        (std::is_void_v<Result> || std::is_same_v<Result, decltype(std::declval<Callable&>()(std::declval<Arguments>()...))>);

}  // namespace detail

/// A non-owning reference to a callable with this signature, as in FunctionRef<bool(int)>.
template <class Signature>
class FunctionRef;

/// Refers to a callable object, which must outlive the reference, or to a function. A lambda written in the call lives until
/// the call returns. To keep a reference, keep the callable first: assigning a temporary is refused.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
    template <class Callable>
    static constexpr bool accepts =
        detail::is_callback<void, Callable, Result, Arguments...> && !std::is_base_of_v<FunctionRef, Callable>;

  public:
    /// Refers to nothing, and must not be called.
    FunctionRef() noexcept = default;
    /// Refers to a function; to nothing for a null pointer.
    FunctionRef(Result (*function)(Arguments...)) noexcept  // NOLINT(google-explicit-constructor)
        : any_function(reinterpret_cast<void (*)()>(function)), call_(function != nullptr ? &call_function : nullptr) {}
    /// Refers to an object that can be called with these arguments and outlives the reference.
    template <class Callable, std::enable_if_t<accepts<std::remove_reference_t<Callable>>, int> = 0>
    FunctionRef(Callable&& object) noexcept  // NOLINT(google-explicit-constructor,bugprone-forwarding-reference-overload)
        : any_object(const_cast<void*>(static_cast<const void*>(&object))),
          call_(&call_object<std::remove_reference_t<Callable>>) {}
    template <class Callable, std::enable_if_t<accepts<Callable>, int> = 0>
    FunctionRef& operator=(const Callable&&) = delete;  ///< refused: a temporary would not outlive the statement

    /// Calls what it refers to.
    Result operator()(Arguments... arguments) const { return call_(*this, std::forward<Arguments>(arguments)...); }
    /// Whether it refers to a callable.
    explicit operator bool() const noexcept { return call_ != nullptr; }

  private:
    template <class Object>
    static Result call_object(const FunctionRef& self, Arguments... arguments) {
        Object& object = *static_cast<Object*>(self.any_object);
        if constexpr (std::is_void_v<Result>) object(std::forward<Arguments>(arguments)...);
        else return object(std::forward<Arguments>(arguments)...);
    }
    static Result call_function(const FunctionRef& self, Arguments... arguments) {
        return reinterpret_cast<Result (*)(Arguments...)>(self.any_function)(std::forward<Arguments>(arguments)...);
    }

    union {
        void* any_object = nullptr;
        void (*any_function)();
    };
    Result (*call_)(const FunctionRef& self, Arguments... arguments) = nullptr;
};

}  // namespace hmesh

#include "hmesh/core/macros/pop.hpp"

#endif  // HMESH_CORE_FUNCTION_REF_HPP
