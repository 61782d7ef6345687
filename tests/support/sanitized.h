// SPDX-License-Identifier: GPL-3.0-or-later
// Whether this program was built with the address sanitizer, for what it makes slower or larger.
#pragma once

namespace meshlode::test {

#if defined(__SANITIZE_ADDRESS__)
inline constexpr bool kIsSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
inline constexpr bool kIsSanitized = true;
#else
inline constexpr bool kIsSanitized = false;
#endif
#else
inline constexpr bool kIsSanitized = false;
#endif

}  // namespace meshlode::test
