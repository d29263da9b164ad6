// What every function has in common that finds a model by its name.
#pragma once

#include "schuler/core/error.h"

#include <gtest/gtest.h>

#include <string>
#include <string_view>
#include <vector>

namespace schuler::sensor::testing {

/// All known names are found, and an unknown one is refused with a list of them.
template <class Find>
void expect_names(const std::vector<std::string_view>& names, const std::string& unknown, Find find) {
    for (const std::string_view name : names) EXPECT_NO_THROW((void)find(name)) << name;
    try {
        (void)find(unknown);
        FAIL();
    } catch (const Error& error) {
        EXPECT_EQ(error.kind(), ErrorKind::Input);
        EXPECT_NE(std::string(error.what()).find(unknown), std::string::npos);
        for (const std::string_view name : names) EXPECT_NE(error.hint().find(name), std::string::npos) << name;
    }
}

}  // namespace schuler::sensor::testing
