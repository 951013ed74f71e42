#pragma once

/// Closed lists of models.
namespace strainwave {

template <template <class...> class... Law>
struct List {};

namespace detail {
template <class L, template <class...> class... More>
struct Extension;
template <template <class...> class... Law, template <class...> class... More>
struct Extension<List<Law...>, More...> {
    using type = List<Law..., More...>;
};
}  // namespace detail
/// A list, and the laws that may modulate its laws.
template <class L, template <class...> class... More>
using Extended = typename detail::Extension<L, More...>::type;

}  // namespace strainwave
