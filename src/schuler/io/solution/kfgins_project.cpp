#include "schuler/core/units.h"
#include "schuler/earth/earth.h"
#include "schuler/io/formats.h"
#include "schuler/io/place.h"
#include "schuler/io/solution/kfgins.h"
#include "schuler/io/text/columns.h"
#include "schuler/math/rotation.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <numbers>
#include <set>

namespace schuler::io {
namespace {

using Eigen::Vector3d;

constexpr double mgal_bias = units::mgal;

/// One mapping of the YAML file with the keys requested so far, so that the remaining ones are unknown.
class Mapping {
public:
    Mapping(YAML::Node node, std::string file, std::string prefix)
        : node_(std::move(node)), file_(std::move(file)), prefix_(std::move(prefix)) {}

    [[nodiscard]] Error error(const YAML::Node& at, const std::string& key, const std::string& what,
                              const std::string& hint) const {
        const long line = at.Mark().is_null() ? 0 : at.Mark().line + 1;
        return input_error(what, place_in(file_, line, 0, prefix_ + key), hint);
    }

    [[nodiscard]] YAML::Node find(const std::string& key) {
        known_.insert(key);
        return node_[key];
    }

    /// The first of several key names that exists.
    [[nodiscard]] std::string present(std::initializer_list<const char*> names) {
        std::string found = *names.begin();
        for (const char* name : names) {
            if (find(name)) found = name;
        }
        return found;
    }

    [[nodiscard]] double number_of(const YAML::Node& value, const std::string& key) const {
        const std::string text = value.IsScalar() ? value.Scalar() : std::string();
        const double number = number_from(text);
        if (std::isnan(number)) {
            const std::string got = value.IsScalar() ? "'" + text + "'" : std::string(value.IsSequence() ? "a list" : "no value");
            throw error(value, key, fmt::format("{} is not a number", got), "write a number, such as 1.5");
        }
        return number;
    }

    [[nodiscard]] double number(const std::string& key, std::optional<double> otherwise, double unit = 1.0) {
        const YAML::Node value = find(key);
        if (value) return number_of(value, key) * unit;
        if (otherwise) return *otherwise;
        throw error(node_, key, "is missing", fmt::format("add {}: NUMBER", key));
    }

    /// Three numbers, or one for all three axes.
    [[nodiscard]] Vector3d vector(const std::string& key, std::optional<Vector3d> otherwise, double unit = 1.0) {
        const YAML::Node value = find(key);
        if (!value) {
            if (otherwise) return *otherwise;
            throw error(node_, key, "is missing", fmt::format("add {}: [ x, y, z ]", key));
        }
        if (value.IsScalar()) return Vector3d::Constant(number_of(value, key) * unit);
        if (!value.IsSequence() || value.size() != 3) {
            throw error(value, key, fmt::format("has {} elements instead of 3", value.size()),
                        fmt::format("write {}: [ x, y, z ]", key));
        }
        Vector3d v;
        for (std::size_t i = 0; i < 3; ++i) v(static_cast<Eigen::Index>(i)) = number_of(value[i], key) * unit;
        return v;
    }

    [[nodiscard]] Vector3d sigmas(const std::string& key, std::optional<Vector3d> otherwise, double unit = 1.0) {
        const Vector3d v = vector(key, otherwise, unit);
        if ((v.array() < 0.0).any())
            throw error(node_[key], key, "a standard deviation is negative", "write numbers of zero or more");
        return v;
    }

    [[nodiscard]] std::string text(const std::string& key, std::optional<std::string> otherwise) {
        const YAML::Node value = find(key);
        if (!value) {
            if (otherwise) return *otherwise;
            throw error(node_, key, "is missing", fmt::format("add {}: \"PATH\"", key));
        }
        if (!value.IsScalar()) throw error(value, key, "is not a text", fmt::format("write {}: \"PATH\"", key));
        return value.Scalar();
    }

    void refuse_unknown() const {
        const std::vector<std::string> known(known_.begin(), known_.end());
        for (const auto& entry : node_) {
            const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "?";
            if (known_.contains(key)) continue;
            const std::string near = nearest_name(key, known);
            throw error(entry.first, key, "is not a known key",
                        near.empty() ? "delete it" : fmt::format("did you mean '{}'?", near));
        }
    }

private:
    YAML::Node node_;
    std::string file_;
    std::string prefix_;
    std::set<std::string> known_;
};

std::filesystem::path located(const std::string& text, const std::filesystem::path& folder) {
    const std::filesystem::path path(text);
    if (path.is_absolute() || text.empty()) return path;
    std::error_code ignored;
    if (std::filesystem::exists(folder / path, ignored)) return folder / path;
    if (std::filesystem::exists(path, ignored)) return path;
    if (std::filesystem::exists(folder / path.filename(), ignored)) return folder / path.filename();
    return folder / path;
}

void read_noise(Mapping& root, const std::string& file, KfGinsProject& p) {
    const YAML::Node node = root.find("imunoise");
    if (!node || !node.IsMap()) {
        throw root.error(node ? node : root.find("imupath"), "imunoise", "is missing or has no keys",
                         "add imunoise: with arw, vrw, gbstd, abstd, gsstd, asstd, corrtime");
    }
    Mapping noise(node, file, "imunoise.");
    p.noise.angle_random_walk = noise.sigmas("arw", {}, units::deg_per_sqrt_hour);
    p.noise.velocity_random_walk = noise.sigmas("vrw", {}, units::m_s_per_sqrt_hour);
    p.noise.gyro_bias = noise.sigmas("gbstd", {}, units::deg_per_hour);
    p.noise.accel_bias = noise.sigmas("abstd", {}, mgal_bias);
    p.noise.gyro_scale = noise.sigmas("gsstd", Vector3d::Zero(), units::ppm);
    p.noise.accel_scale = noise.sigmas("asstd", Vector3d::Zero(), units::ppm);
    p.noise.correlation_time = noise.number("corrtime", {}, units::hour);
    if (p.noise.correlation_time <= 0.0)
        throw noise.error(noise.find("corrtime"), "corrtime", "is not positive", "write a time in hours, such as 1");
    noise.refuse_unknown();
}

void read_initial(Mapping& root, KfGinsProject& p) {
    const Vector3d position = root.vector("initpos", {});
    if (std::abs(position.x()) > 90.0)
        throw root.error(root.find("initpos"), "initpos", fmt::format("a latitude of {} deg", position.x()),
                         "write latitude, longitude (deg), height (m)");
    if (std::abs(position.y()) > 360.0)
        throw root.error(root.find("initpos"), "initpos", fmt::format("a longitude of {} deg", position.y()),
                         "write latitude, longitude (deg), height (m)");
    p.position = {position.x() * units::deg, std::remainder(position.y() * units::deg, 2.0 * std::numbers::pi), position.z()};
    p.velocity_n = root.vector("initvel", {});
    p.rpy = root.vector("initatt", {}, units::deg);
    p.gyro_bias = root.vector("initgyrbias", Vector3d::Zero(), units::deg_per_hour);
    p.accel_bias = root.vector("initaccbias", Vector3d::Zero(), mgal_bias);
    p.gyro_scale = root.vector("initgyrscale", Vector3d::Zero(), units::ppm);
    p.accel_scale = root.vector("initaccscale", Vector3d::Zero(), units::ppm);
    p.std_position = root.sigmas("initposstd", {});
    p.std_velocity = root.sigmas("initvelstd", {});
    p.std_rpy = root.sigmas("initattstd", {}, units::deg);
    p.std_gyro_bias = root.sigmas(root.present({"initbgstd", "initgyrbiasstd"}), p.noise.gyro_bias, units::deg_per_hour);
    p.std_accel_bias = root.sigmas(root.present({"initbastd", "initaccbiasstd"}), p.noise.accel_bias, mgal_bias);
    p.std_gyro_scale = root.sigmas(root.present({"initsgstd", "initgyrscalestd"}), p.noise.gyro_scale, units::ppm);
    p.std_accel_scale = root.sigmas(root.present({"initsastd", "initaccscalestd"}), p.noise.accel_scale, units::ppm);
}

/// OB_GINS: the same files under other names, without a position and initial sigmas. The position is that of the first fix from the start on.
void read_ob_gins(Mapping& root, const std::string& file, KfGinsProject& p) {
    p.velocity_n = root.vector("initvel", Vector3d::Zero());
    p.rpy = root.vector("initatt", Vector3d::Zero(), units::deg);
    p.gyro_bias = root.vector("initgb", Vector3d::Zero(), units::deg_per_hour);
    p.accel_bias = root.vector("initab", Vector3d::Zero(), mgal_bias);
    const YAML::Node node = root.find("imumodel");
    if (!node || !node.IsMap())
        throw root.error(node ? node : root.find("imufile"), "imumodel", "is missing or has no keys",
                         "add imumodel: with arw, vrw, gbstd, abstd, corrtime");
    Mapping noise(node, file, "imumodel.");
    p.noise.angle_random_walk = noise.sigmas("arw", {}, units::deg_per_sqrt_hour);
    p.noise.velocity_random_walk = noise.sigmas("vrw", {}, units::m_s_per_sqrt_hour);
    p.noise.gyro_bias = noise.sigmas("gbstd", {}, units::deg_per_hour);
    p.noise.accel_bias = noise.sigmas("abstd", {}, mgal_bias);
    p.noise.correlation_time = noise.number("corrtime", {}, units::hour);
    noise.refuse_unknown();
    // of the optimisation, the odometer and simulated outages: not relevant for a filter
    for (const char* key :
         {"windows", "num_iterations", "is_outlier_culling", "isearth", "odolever", "bodyangle", "odometer", "isuseoutage",
          "outagetime", "outagelen", "outageperiod", "gnssthreshold", "integrationlength", "isusegnssoutage"})
        (void)root.find(key);
    p.std_gyro_bias = p.noise.gyro_bias;
    p.std_accel_bias = p.noise.accel_bias;
    p.std_velocity = Vector3d::Constant(0.5);           // m/s: its initial velocity is rounded
    p.std_rpy = Vector3d(2.0, 2.0, 10.0) * units::deg;  // its initial attitude is estimated from the log
    WarningLog nothing;
    for (const GnssFix& fix : read_kfgins_gnss(TextInput(p.gnss_path), nothing).fixes) {
        p.position = fix.position;
        p.std_position = fix.std_position;
        if (fix.time >= p.start) break;
    }
    // the fix is that of the antenna
    p.position = earth::moved_by_ned({}, p.position, math::dcm_from_rpy(p.rpy) * -p.lever_arm_b);
    p.std_position = (p.std_position.array().square() + std::pow(p.std_rpy.norm() * p.lever_arm_b.norm(), 2)).sqrt();
}

YAML::Node load(const std::string& text, const std::string& file) {
    try {
        return YAML::Load(text);
    } catch (const YAML::Exception& e) {
        throw input_error(fmt::format("is not valid YAML: {}", e.msg), place_in(file, e.mark.is_null() ? 0 : e.mark.line + 1),
                          "check indents, brackets and quotes there");
    }
}

}  // namespace

KfGinsProject read_kfgins_project(const TextInput& input, std::filesystem::path folder) {
    const std::string& file = input.name();
    const YAML::Node node = load(read_text(input, 1024 * 1024), file);
    if (!node.IsMap())
        throw input_error("has no keys", place_in(file, 1),
                          "is it a KF-GINS settings file? it has lines such as imupath: \"imu.txt\"");
    if (folder.empty()) folder = std::filesystem::path(file).parent_path();
    try {
        Mapping root(node, file, "");
        KfGinsProject p;
        const bool ob_gins = !node["imupath"] && node["imufile"];
        p.imu_path = located(root.text(ob_gins ? "imufile" : "imupath", {}), folder);
        p.gnss_path = located(root.text(ob_gins ? "gnssfile" : "gnsspath", {}), folder);
        p.output_path = located(root.text("outputpath", ""), folder);
        const double columns = root.number("imudatalen", 7.0);
        if (columns < 7.0 || columns > 1000.0)
            throw root.error(root.find("imudatalen"), "imudatalen",
                             "is below 7 (time, three angle and three velocity increments)", "write 7");
        p.imu_columns = static_cast<int>(columns);
        p.imu_rate_hz = root.number("imudatarate", 200.0);
        if (p.imu_rate_hz <= 0.0)
            throw root.error(root.find("imudatarate"), "imudatarate", "is not positive", "write the rate in Hz, such as 200");
        const double start = root.number("starttime", 0.0), end = root.number("endtime", -1.0);
        for (const double t : {start, end}) {
            if (std::abs(t) > 4e9)
                throw root.error(root.find(t == start ? "starttime" : "endtime"), t == start ? "starttime" : "endtime",
                                 "is out of range", "write seconds of the week");
        }
        p.start = Time::from_seconds(start);
        if (end >= 0.0) p.end = Time::from_seconds(end);
        if (p.end && *p.end <= p.start)
            throw root.error(root.find("endtime"), "endtime", "is not after starttime",
                             "write a later time, or -1 for the end of the data");
        p.lever_arm_b = root.vector("antlever", Vector3d::Zero());
        if (ob_gins) {
            read_ob_gins(root, file, p);
        } else {
            read_noise(root, file, p);
            read_initial(root, p);
        }
        root.refuse_unknown();
        return p;
    } catch (const YAML::Exception& e) {
        throw input_error(e.msg, place_in(file, e.mark.is_null() ? 0 : e.mark.line + 1),
                          "compare with the example in the documentation");
    }
}

bool is_kfgins_project(const TextInput& input) {
    try {
        const YAML::Node node = YAML::Load(read_text(input, 1024 * 1024));
        return node.IsMap() && ((node["imupath"] && node["gnsspath"]) || (node["imufile"] && node["gnssfile"]));
    } catch (const YAML::Exception&) {
        return false;
    } catch (const Error&) {
        return false;
    }
}

extern const Format kfgins_yaml_format;
const Format kfgins_yaml_format = {
    .name = "kfgins_yaml",
    .title = "KF-GINS or OB_GINS project",
    .extensions = ".yaml .yml",
    .holds =
        "settings with the paths of an IMU and a GNSS file; of OB_GINS (`imufile`, `gnssfile`) the position is that of the first fix, and what is of its optimisation, "
        "odometer and outages is left",
    .time = "seconds of the GPS week",
    .recognise = [](const FileHead& head) {
        // The paths are sought first: to parse every file as YAML would take long.
        const bool paths =
            (head.contains("imupath") && head.contains("gnsspath")) || (head.contains("imufile") && head.contains("gnssfile"));
        return paths && !head.contains(std::string_view("\0", 1)) && is_kfgins_project(TextInput(head.path));
    }};

}  // namespace schuler::io
