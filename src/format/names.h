// SPDX-License-Identifier: MIT
// The names of the format's enums: of options, META and reports.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include <meshlode/format.h>

#include "base/enum_names.h"

namespace meshlode::format {

inline constexpr std::array<EnumName<Codec>, 5> kCodecNames{{{Codec::kNone, "none"},
                                                             {Codec::kLz4, "lz4"},
                                                             {Codec::kZstd, "zstd"},
                                                             {Codec::kStrips, "strips"},
                                                             {Codec::kDraco, "draco"}}};

/// Codecs that are written. Earlier development versions wrote the others; a build with MESHLODE_OLD_CODECS reads them.
inline constexpr std::array<EnumName<Codec>, 2> kWrittenCodecNames{
    {{Codec::kStrips, "strips"}, {Codec::kNone, "none"}}};

inline constexpr std::array<EnumName<ErrorTier>, 3> kErrorTierNames{
    {{ErrorTier::kQem, "qem"}, {ErrorTier::kMeasured, "measured"}, {ErrorTier::kCertified, "certified"}}};

inline constexpr std::array<EnumName<Promise>, 3> kPromiseNames{
    {{Promise::kPosition, "position"}, {Promise::kTexels, "texels"}, {Promise::kAppearance, "appearance"}}};

inline constexpr std::array<EnumName<NormalMode>, 3> kNormalModeNames{
    {{NormalMode::kNone, "none"}, {NormalMode::kStored, "stored"}, {NormalMode::kFlat, "flat"}}};

/// glTF's.
inline constexpr std::array<EnumName<AlphaMode>, 3> kAlphaModeNames{
    {{AlphaMode::kOpaque, "OPAQUE"}, {AlphaMode::kMask, "MASK"}, {AlphaMode::kBlend, "BLEND"}}};

inline constexpr std::array<EnumName<StuckReason>, 8> kStuckReasonNames{{{StuckReason::kNotStuck, "not_stuck"},
                                                                         {StuckReason::kLocked, "locked"},
                                                                         {StuckReason::kFlips, "flips"},
                                                                         {StuckReason::kSeams, "seams"},
                                                                         {StuckReason::kComponents, "components"},
                                                                         {StuckReason::kTooSmall, "too_small"},
                                                                         {StuckReason::kTopology, "topology"},
                                                                         {StuckReason::kBorder, "border"}}};

constexpr const char* name_of(Codec codec) {
  return name_in(kCodecNames, codec);
}
/// The message for a codec that is no longer written.
inline std::string not_written(std::string_view codec) {
  return "'" + std::string(codec) + "' is not written any more; choose strips or none";
}
constexpr bool is_written(Codec codec) {
  return codec == Codec::kNone || codec == Codec::kStrips;
}
constexpr const char* name_of(ErrorTier tier) {
  return name_in(kErrorTierNames, tier);
}
constexpr const char* name_of(Promise promise) {
  return name_in(kPromiseNames, promise);
}
constexpr const char* name_of(NormalMode mode) {
  return name_in(kNormalModeNames, mode);
}
constexpr const char* name_of(AlphaMode mode) {
  return name_in(kAlphaModeNames, mode);
}
constexpr const char* name_of(StuckReason reason) {
  return name_in(kStuckReasonNames, reason);
}

}  // namespace meshlode::format
