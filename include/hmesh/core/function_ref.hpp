/// \file
/// FunctionRef: a reference to any callable, so that what takes a callback is compiled once.
///
/// Two words, nothing allocated; a call costs one jump through a pointer, some 2 ns. As C++26's std::function_ref, except that
/// it may refer to nothing, and that what it calls must return the very type that was asked for: a count where a bool is
/// wanted is a mistake.
#ifndef HMESH_CORE_FUNCTION_REF_HPP
#define HMESH_CORE_FUNCTION_REF_HPP

#include <memory>
#include <type_traits>
#include <utility>

#include "hmesh/core/macros/push.hpp"

namespace hmesh {

template <class Signature>
class FunctionRef;

/// Refers to an object, which must outlive the reference, or holds a pointer to a function. A lambda written in the call is
/// fine: it lives until the call returns. To keep a reference, keep the callable first: assigning a temporary is refused.
template <class Result, class... Arguments>
class FunctionRef<Result(Arguments...)> {
    template <class Callable>
    [[nodiscard]] static constexpr bool accepts() noexcept {
        if constexpr (!std::is_class_v<Callable> || std::is_base_of_v<FunctionRef, Callable>) return false;
        else if constexpr (!std::is_invocable_v<Callable&, Arguments...>) return false;
        else return std::is_void_v<Result> || std::is_same_v<Result, std::invoke_result_t<Callable&, Arguments...>>;
    }

  public:
    /// Refers to nothing; must not be called.
    FunctionRef() noexcept = default;
    /// To a function.
    FunctionRef(Result (*function)(Arguments...)) noexcept  // NOLINT(google-explicit-constructor)
        : any_function(reinterpret_cast<void (*)()>(function)), call_(function != nullptr ? &call_function : nullptr) {}
    /// To an object that can be called with these arguments.
    template <class Callable, std::enable_if_t<accepts<std::remove_reference_t<Callable>>(), int> = 0>
    FunctionRef(Callable&& object) noexcept  // NOLINT(google-explicit-constructor,bugprone-forwarding-reference-overload)
        : any_object(const_cast<void*>(static_cast<const void*>(std::addressof(object)))),
          call_(&call_object<std::remove_reference_t<Callable>>) {}
    template <class Callable, std::enable_if_t<accepts<Callable>(), int> = 0>
    FunctionRef& operator=(const Callable&&) = delete;  // it would not outlive the statement

    Result operator()(Arguments... arguments) const { return call_(*this, std::forward<Arguments>(arguments)...); }
    /// Whether it refers to anything.
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
