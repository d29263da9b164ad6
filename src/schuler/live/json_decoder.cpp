// JSON lines: samples of any instrument, and gpsd reports.
#include "schuler/core/units.h"
#include "schuler/io/receiver/ubx.h"
#include "schuler/live/detail/framing.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

namespace schuler::live::detail {
namespace {

using Json = nlohmann::json;

double number_of(const Json& j, const char* key, double otherwise = not_given) {
    const auto it = j.find(key);
    return it != j.end() && it->is_number() ? it->get<double>() : otherwise;
}

Eigen::Vector3d vector_of(const Json& j, const char* key) {
    const auto it = j.find(key);
    if (it == j.end() || !it->is_array() || it->size() != 3) return not_given3();
    Eigen::Vector3d out;
    for (std::size_t i = 0; i < 3; ++i)
        out[static_cast<Eigen::Index>(i)] = (*it)[i].is_number() ? (*it)[i].get<double>() : not_given;
    return out;
}

/// One to three heights.
Eigen::Vector3d heights_of(const Json& j, const char* key) {
    Eigen::Vector3d out = not_given3();
    const auto it = j.find(key);
    if (it == j.end() || !it->is_array() || it->size() > 3) return out;
    for (std::size_t i = 0; i < it->size(); ++i)
        if ((*it)[i].is_number()) out[static_cast<Eigen::Index>(i)] = (*it)[i].get<double>();
    return out;
}

/// time_ns, an integer, or time_s.
std::optional<Time> time_of(const Json& j) {
    if (const auto ns = j.find("time_ns"); ns != j.end() && ns->is_number_integer()) return Time{ns->get<std::int64_t>()};
    const double s = number_of(j, "time_s");
    if (!std::isfinite(s)) return std::nullopt;
    return Time::from_seconds(s);
}

class JsonDecoder : public Decoder {
public:
    void take(std::string_view bytes, std::vector<Sample>& out) override {
        lines_.take(
            bytes, [&](std::string_view line) { take_line(line, out); }, [&] { bad("no line end"); });
    }
    void reset() override { lines_.reset(); }

protected:
    /// True if it was decoded.
    virtual bool message(const Json& j, std::vector<Sample>& out) {
        const auto type = j.find("type");
        const auto time = time_of(j);
        if (type == j.end() || !type->is_string() || !time) return false;
        const std::string kind = type->get<std::string>();
        if (kind == "imu") {
            const ImuSample s{*time, vector_of(j, "gyro_rad_s"), vector_of(j, "accel_m_s2")};
            out.emplace_back(s);
        } else if (kind == "gnss") {
            GnssFix f;
            f.time = *time;
            f.position = {number_of(j, "lat_deg") * units::deg, number_of(j, "lon_deg") * units::deg, number_of(j, "height_m")};
            if (j.contains("lat_rad")) f.position = {number_of(j, "lat_rad"), number_of(j, "lon_rad"), number_of(j, "height_m")};
            f.velocity_n = vector_of(j, "velocity_m_s");
            f.std_position = vector_of(j, "std_m");
            f.std_velocity = vector_of(j, "std_velocity_m_s");
            f.satellites = static_cast<int>(number_of(j, "satellites", -1.0));
            f.position_age = number_of(j, "position_age_s", 0.0);
            f.velocity_age = number_of(j, "velocity_age_s", 0.0);
            const double fix = number_of(j, "fix", static_cast<double>(FixType::Unknown));
            if (fix >= 0.0 && fix <= static_cast<double>(FixType::Unknown)) f.fix = static_cast<FixType>(fix);
            out.emplace_back(f);
        } else if (kind == "baro") {
            BaroSample s;
            s.time = *time;
            s.height = number_of(j, "height_m");
            s.pressure = number_of(j, "pressure_pa");
            out.emplace_back(s);
        } else if (kind == "mag") {
            out.emplace_back(MagSample{*time, vector_of(j, "field_t")});
        } else if (kind == "odometer") {
            out.emplace_back(OdometerSample{*time, number_of(j, "speed_m_s"), number_of(j, "std_m_s")});
        } else if (kind == "heading") {
            out.emplace_back(
                HeadingSample{*time, number_of(j, "heading_deg") * units::deg, number_of(j, "std_deg") * units::deg});
        } else if (kind == "gauges") {
            out.emplace_back(GaugeSample{*time, heights_of(j, "height_m")});
        } else if (kind == "log") {
            out.emplace_back(BodyVelocitySample{*time, vector_of(j, "velocity_m_s")});
        } else {
            ++counters_.foreign;
            return true;
        }
        ++counters_.messages;
        return true;
    }

private:
    void take_line(std::string_view line, std::vector<Sample>& out) {
        const Json j = Json::parse(line, nullptr, false);
        if (j.is_discarded() || !j.is_object()) return bad("a line that is not a JSON object");
        if (!message(j, out)) bad("an object without type and time");
    }

    Lines lines_;
};

/// TPV reports of gpsd's protocol (version 3) with a fix, and the satellites of SKY reports.
class GpsdDecoder final : public JsonDecoder {
protected:
    bool message(const Json& j, std::vector<Sample>& out) override {
        const auto kind = j.find("class");
        if (kind == j.end() || !kind->is_string()) return false;
        if (*kind == "SKY") return sky(j);
        const auto stamp = j.find("time");
        if (*kind != "TPV" || number_of(j, "mode", 0.0) < 2.0 || stamp == j.end() || !stamp->is_string()) {
            ++counters_.foreign;
            return true;
        }
        Calendar c{};
        if (std::sscanf(stamp->get_ref<const std::string&>().c_str(), "%4d-%2d-%2dT%2d:%2d:%lf", &c.year, &c.month, &c.day,
                        &c.hour, &c.minute, &c.second) != 6)
            return false;
        GnssFix f;
        f.time = gps_from_utc(c);
        f.position = {number_of(j, "lat") * units::deg, number_of(j, "lon") * units::deg,
                      number_of(j, "altHAE", number_of(j, "alt"))};
        const double track = number_of(j, "track") * units::deg, speed = number_of(j, "speed");
        f.velocity_n = {speed * std::cos(track), speed * std::sin(track), -number_of(j, "climb")};
        // its error estimates are 95 % values
        constexpr double two_sigma = 2.0;
        f.std_position = {number_of(j, "epy") / two_sigma, number_of(j, "epx") / two_sigma, number_of(j, "epv") / two_sigma};
        out.emplace_back(f);
        ++counters_.messages;
        return true;
    }

private:
    bool sky(const Json& j) {
        const auto list = j.find("satellites");
        if (list == j.end() || !list->is_array()) {  // only dilutions
            ++counters_.foreign;
            return true;
        }
        std::vector<SatelliteSeen> all;
        constexpr std::size_t most = 200;
        for (const Json& s : *list) {
            if (!s.is_object() || all.size() == most) continue;
            const double system = number_of(s, "gnssid", -1.0), number = number_of(s, "svid", -1.0);
            if (!(std::abs(system) < 256.0 && std::abs(number) < 256.0)) continue;
            const auto id = io::ubx_satellite(static_cast<int>(system), static_cast<int>(number));
            if (!id) continue;
            const double strength = number_of(s, "ss");
            const auto used = s.find("used");
            all.push_back({*id, number_of(s, "el") * units::deg, number_of(s, "az") * units::deg,
                           strength > 0.0 ? strength : not_given, used != s.end() && used->is_boolean() && used->get<bool>()});
        }
        satellites_.replace(std::move(all));
        ++counters_.messages;
        return true;
    }
};

}  // namespace

std::unique_ptr<Decoder> json_decoder() { return std::make_unique<JsonDecoder>(); }
std::unique_ptr<Decoder> gpsd_decoder() { return std::make_unique<GpsdDecoder>(); }

}  // namespace schuler::live::detail
