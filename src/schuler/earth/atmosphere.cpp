#include "schuler/earth/atmosphere.h"

#include "schuler/core/fail.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string>

namespace schuler::earth {
namespace {

constexpr double g0 = 9.80665;        // m/s^2
constexpr double gas = 287.05287;     // m^2/(K s^2), of air
constexpr double radius = 6356766.0;  // m, nominal
constexpr double lowest = -5000.0, highest = 80000.0;

/// A layer of constant temperature gradient, from its base (geopotential m) to the next.
struct Layer {
    double base;
    double temperature;  // K, at the base
    double gradient;     // K/m
    double pressure;     // Pa, at the base
};

double pressure_in(const Layer& layer, double height) {
    const double dh = height - layer.base;
    if (layer.gradient == 0.0) return layer.pressure * std::exp(-g0 * dh / (gas * layer.temperature));
    return layer.pressure * std::exp(-g0 / (gas * layer.gradient) * std::log1p(layer.gradient * dh / layer.temperature));
}

double height_in(const Layer& layer, double pressure) {
    const double log_ratio = std::log(pressure / layer.pressure);
    if (layer.gradient == 0.0) return layer.base - gas * layer.temperature / g0 * log_ratio;
    return layer.base + layer.temperature / layer.gradient * std::expm1(-gas * layer.gradient / g0 * log_ratio);
}

std::array<Layer, 7> standard_layers() {
    std::array<Layer, 7> layers{{{0.0, 288.15, -6.5e-3, 101325.0},
                                 {11000.0, 0.0, 0.0, 0.0},
                                 {20000.0, 0.0, 1.0e-3, 0.0},
                                 {32000.0, 0.0, 2.8e-3, 0.0},
                                 {47000.0, 0.0, 0.0, 0.0},
                                 {51000.0, 0.0, -2.8e-3, 0.0},
                                 {71000.0, 0.0, -2.0e-3, 0.0}}};
    for (std::size_t i = 1; i < layers.size(); ++i) {
        const Layer& below = layers[i - 1];
        layers[i].temperature = below.temperature + below.gradient * (layers[i].base - below.base);
        layers[i].pressure = pressure_in(below, layers[i].base);
    }
    return layers;
}

const std::array<Layer, 7>& layers() {
    static const std::array<Layer, 7> table = standard_layers();
    return table;
}

}  // namespace

StandardAir standard_air(double geopotential_height) {
    if (!(geopotential_height >= lowest && geopotential_height <= highest))
        fail(input_error(fmt::format("height {} m is outside the standard atmosphere", geopotential_height), {},
                         "give geopotential metres from -5000 to 80000"));
    const std::array<Layer, 7>& table = layers();
    std::size_t i = 0;
    while (i + 1 < table.size() && geopotential_height >= table[i + 1].base) ++i;
    const double temperature = table[i].temperature + table[i].gradient * (geopotential_height - table[i].base);
    const double pressure = pressure_in(table[i], geopotential_height);
    return {temperature, pressure, pressure / (gas * temperature)};
}

double static_pressure(double geopotential_height, double sea_level_pressure, double temperature_offset) {
    if (!(sea_level_pressure > 0.0) || !(std::abs(temperature_offset) < 100.0))
        fail(input_error(
            fmt::format("no air has {} Pa at sea level and {} K more than the standard", sea_level_pressure, temperature_offset),
            {}, "give pascals (about 101325) and a few tens of kelvin"));
    (void)standard_air(geopotential_height);  // throws for heights outside
    Layer layer = layers().front();
    layer.temperature += temperature_offset;
    layer.pressure = sea_level_pressure;
    for (std::size_t i = 1; i < layers().size() && layers()[i].base < geopotential_height; ++i) {
        Layer next = layers()[i];
        next.temperature += temperature_offset;
        next.pressure = pressure_in(layer, next.base);
        layer = next;
    }
    return pressure_in(layer, geopotential_height);
}

double geopotential_height_from_pressure(double pressure, double sea_level_pressure) {
    const std::array<Layer, 7>& table = layers();
    static const double smallest = standard_air(highest).pressure * (1.0 - 1e-12);
    static const double largest = standard_air(lowest).pressure * (1.0 + 1e-12);
    const double standard = pressure / sea_level_pressure * table[0].pressure;
    if (!(sea_level_pressure > 0.0) || !(standard >= smallest && standard <= largest))
        fail(input_error(fmt::format("static pressure {} Pa (sea level {} Pa) is outside the standard atmosphere", pressure,
                                     sea_level_pressure),
                         {}, "give pascals: 1 hPa or mbar is 100 Pa"));
    std::size_t i = 0;
    while (i + 1 < table.size() && standard <= table[i + 1].pressure) ++i;
    return height_in(table[i], standard);
}

double geometric_from_geopotential(double geopotential_height) {
    return radius * geopotential_height / (radius - geopotential_height);
}

double geopotential_from_geometric(double geometric_height) { return radius * geometric_height / (radius + geometric_height); }

}  // namespace schuler::earth
