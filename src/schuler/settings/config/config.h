// All user settings for processing one data set: meaning of the files, filter, output.
#pragma once

#include "schuler/dataset/description.h"
#include "schuler/fusion/settings.h"
#include "schuler/settings/config/gravity.h"
#include "schuler/settings/config/instruments.h"
#include "schuler/settings/option_table.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace schuler::settings {

using dataset::FileSource;
using dataset::Quaternion;
using dataset::RawGnssConfig;
using dataset::TimeConfig;

enum class Scheme { Gnss, Separate, Loose, Tight, Intermediate, Deep };

/// An outage as given by the user.
struct OutageSpan {
    double start = 0.0;     ///< s, see RunTime::absolute
    double duration = 0.0;  ///< s
    bool absolute = false;  ///< start is on the data set's own axis
};

/// A time of the command line: seconds after the first GNSS epoch, or on the data set's own axis ("abs:T").
struct RunTime {
    double seconds = 0.0;
    bool absolute = false;
};

struct RunConfig {
    std::optional<RunTime> start, stop;
    std::vector<OutageSpan> outages;
    std::optional<double> settle;  ///< s after which errors are evaluated; not given: alignment + 60 s
    bool self_check = true;        ///< of `process`: withhold GNSS in windows and test the sigmas
    bool keep_given = false;       ///< use given values even if refuted by the data
};

struct OutputConfig {
    std::vector<std::string> files{"solution", "summary", "h5", "report", "kml", "config"};
    std::string events;  ///< file of instants for additional output of the solution

    [[nodiscard]] bool wants(std::string_view file) const { return std::ranges::find(files, file) != files.end(); }
};

/// The settings of one run. fusion::Settings is filled by the bindings of config_table(), then by settled().
struct Config : dataset::Description {
    std::string name;
    std::string grade = "consumer";
    double initial_time = not_given;  ///< s on the data set's own axis
    std::string preset = "ins15";
    Scheme scheme = Scheme::Loose;
    std::optional<bool> scale_factors, misalignments;  ///< not given: on if the unit has them, misalignments for a car too
    double leeway = 8.0 * units::deg;  ///< ship: one sigma of the angle between bow and course, rad; 0: course not used
    std::optional<bool> nonholonomic;  ///< not given: on for a car
    fusion::Settings filter;
    GravityConfig gravity;
    InstrumentsConfig instruments;
    RunConfig run;
    OutputConfig output;

    Config();
};

/// As used in settings and summaries.
[[nodiscard]] std::string_view scheme_name(Scheme scheme);
[[nodiscard]] std::string_view loop_name(fusion::Loop loop);

/// The table of options of dataset.toml, --config and --set.
[[nodiscard]] const OptionTable<Config>& config_table();

/// The settings applied to the defaults, with derived settings (constraints of the vehicle kind).
/// @throws Error(Input) with the place of the setting.
[[nodiscard]] Config config_from(const SettingList& settings);

/// What a value of filter.preset that names a coupling stands for; nothing for one that names states.
struct PresetCoupling {
    Scheme scheme;
    fusion::LooseKind loose_kind;
};
[[nodiscard]] std::optional<PresetCoupling> coupling_of_preset(std::string_view preset);

/// Layers of settings, the later ones over the earlier ones: the settings implied by a later imu.grade, filter.preset or ranges.clock are
/// also discarded from earlier layers.
[[nodiscard]] SettingList overlaid(SettingList base, const SettingList& above);

/// "key=value" of the command line. @throws Error(Input) for a missing '=' or an unknown key.
[[nodiscard]] Setting setting_from_text(const std::string& text);

/// "T:DUR[,T:DUR...]", T may be "abs:T". @throws Error(Input).
[[nodiscard]] std::vector<OutageSpan> outages_from_text(const std::string& text);
/// Entries of [[outage]]. @throws Error(Input) without a place.
[[nodiscard]] std::vector<OutageSpan> outages_from_tables(const ValueList& tables);
/// "T" or "abs:T". @throws Error(Input) with the name `option` in the message.
[[nodiscard]] RunTime run_time_from_text(const std::string& text, const std::string& option);

/// C_bs of sensor axes: "frd", "flu", "fur", ... (x, y, z of the sensor pointing forward/back, left/right, up/down) or
/// "x=forward, y=left, z=up". @throws Error(Input) for missing, repeated or left-handed axes.
[[nodiscard]] Eigen::Matrix3d axes_from_text(const std::string& text);

}  // namespace schuler::settings
