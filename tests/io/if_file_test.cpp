// Recordings of samples: what is read of each form, and what is refused because it is not in that form.
#include "schuler/io/receiver/if_file.h"

#include "schuler/core/error.h"
#include "schuler/math/random.h"
#include "support/temporary_folder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>

namespace schuler::io {
namespace {

using Sample = std::complex<std::int8_t>;

class IfFiles : public ::testing::Test {
protected:
    std::filesystem::path put(const std::string& bytes) {
        const auto path = folder_.path() / "recording";
        std::ofstream(path, std::ios::binary) << bytes;
        return path;
    }
    template <class T>
    static std::string written(const std::vector<T>& values) {
        return {reinterpret_cast<const char*>(values.data()), sizeof(T) * values.size()};
    }
    /// I and Q in turn of 4000 samples of Gaussian noise.
    template <class T>
    static std::string noise(double std, double middle = 0.0) {
        math::Random random(1, "if_file");
        std::vector<T> out(8000);
        for (T& x : out) {
            const double value = middle + std * random.normal();
            if constexpr (std::is_integral_v<T>)  // a converter saturates
                x = static_cast<T>(
                    std::clamp<double>(std::floor(value + 0.5), std::numeric_limits<T>::min(), std::numeric_limits<T>::max()));
            else x = static_cast<T>(value);
        }
        return written(out);
    }
    std::string complaint(const std::string& bytes, const char* format, std::uintmax_t start = 0) {
        try {
            (void)IfFile(put(bytes), format, start);
        } catch (const Error& e) {
            EXPECT_EQ(e.kind(), ErrorKind::Input);
            EXPECT_TRUE(e.place().key == "format" || e.place().file.ends_with("recording"));
            EXPECT_FALSE(e.hint().empty());
            return e.reason() + "; " + e.hint();
        }
        return "";
    }
    std::vector<Sample> all_of(const std::string& bytes, const char* format, std::uintmax_t start = 0) {
        IfFile file(put(bytes), format, start);
        std::vector<Sample> out(file.size());
        EXPECT_TRUE(file.read(out));
        Sample more[1];
        EXPECT_FALSE(file.read(more));
        return out;
    }

    schuler::test::TemporaryFolder folder_{"if_file"};
};

TEST_F(IfFiles, BytesAreTheSamples) {
    const std::vector<Sample> expected{{1, -2}, {-128, 127}, {0, 5}};
    EXPECT_EQ(all_of(written<std::int8_t>({1, -2, -128, 127, 0, 5}), "ibyte"), expected);
    EXPECT_EQ(all_of(written<std::uint8_t>({129, 126, 0, 255, 128, 133}), "ubyte"), expected);
    EXPECT_EQ(all_of(written<std::int8_t>({9, 9, 1, -2, -128, 127, 0, 5}), "ibyte", 1), expected);
}

TEST_F(IfFiles, WordsAndFloatsGetARootMeanSquareOf24Steps) {
    // +-s with one larger value, which is cut off at the end of the scale
    std::vector<std::int16_t> words;
    std::vector<float> floats;
    for (int i = 0; i < 2000; ++i) {
        const int x = i == 0 ? 3000 : i % 3 == 0 ? 400 : -200;
        words.push_back(static_cast<std::int16_t>(x));
        floats.push_back(static_cast<float>(x) * 1e-5F);
    }
    const std::vector<Sample> a = all_of(written(words), "ishort"), b = all_of(written(floats), "gr_complex");
    ASSERT_EQ(a.size(), 1000U);
    EXPECT_EQ(a, b);
    EXPECT_EQ(a[0].real(), 127);
    double power = 0.0;
    for (const Sample& s : a) power += (s.real() * s.real() + s.imag() * s.imag()) / 2000.0;
    EXPECT_NEAR(std::sqrt(power), 24.0, 1.5);
    EXPECT_NEAR(static_cast<double>(a[3].real()) / a[3].imag(), -2.0, 0.1) << "proportions stay";
}

TEST_F(IfFiles, AnotherFormIsNoticed) {
    struct Form {
        const char* name;
        std::string bytes;
    };
    const std::string middle = noise<std::uint8_t>(24.0, 127.5);
    const Form forms[] = {{"ibyte", noise<std::int8_t>(24.0)},
                          {"ubyte", middle},
                          {"ishort", noise<std::int16_t>(900.0)},
                          {"gr_complex", noise<float>(0.02)}};
    for (const Form& is : forms) {
        for (const char* said : {"ibyte", "ubyte", "ishort", "gr_complex"}) {
            // floats taken for words have no mark
            if (std::string_view(is.name) == "gr_complex" && std::string_view(said) == "ishort") continue;
            EXPECT_EQ(complaint(is.bytes, said).empty(), std::string_view(is.name) == said) << is.name << " read as " << said;
        }
    }
    EXPECT_NE(complaint(middle, "ibyte").find("ubyte"), std::string::npos) << "the mend names the form";
    EXPECT_EQ(complaint(noise<std::int8_t>(3.0), "ibyte"), "") << "two bits are enough";
    EXPECT_EQ(complaint(noise<std::int16_t>(6.0), "ishort"), "");
    EXPECT_EQ(complaint(noise<std::int16_t>(9000.0), "ishort"), "");
}

TEST_F(IfFiles, WhatIsNoRecordingIsRefused) {
    const std::string good = noise<std::int8_t>(24.0);
    EXPECT_EQ(complaint(good, "ibyte"), "");
    EXPECT_NE(complaint(good, "wav").find("gr_complex"), std::string::npos);
    EXPECT_NE(complaint("", "ibyte"), "");
    EXPECT_NE(complaint(good + "x", "ibyte").find("end within a sample"), std::string::npos);
    EXPECT_NE(complaint(good + "xy", "ishort").find("end within a sample"), std::string::npos);
    EXPECT_NE(complaint(good, "ibyte", 4000).find("none after"), std::string::npos);
    EXPECT_NE(complaint(std::string(8000, '\0'), "ibyte").find("one value"), std::string::npos);
    EXPECT_NE(complaint(noise<std::int8_t>(5.0, 40.0), "ibyte").find("constant"), std::string::npos);
    std::string one_channel = good;
    for (std::size_t i = 1; i < one_channel.size(); i += 2) one_channel[i] = 0;
    EXPECT_NE(complaint(one_channel, "ibyte").find("differ in power"), std::string::npos);
    std::vector<float> floats(8000, 0.5F);
    for (std::size_t i = 0; i < floats.size(); i += 3) floats[i] = -0.5F;
    EXPECT_EQ(complaint(written(floats), "gr_complex"), "");
    floats[500] = std::nanf("");
    EXPECT_NE(complaint(written(floats), "gr_complex").find("not samples"), std::string::npos);
}

}  // namespace
}  // namespace schuler::io
