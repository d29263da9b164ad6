// How each setting of a run is known, with the values that were in force; and the settings that repeat the run.
#pragma once

#include "schuler/app/bundle.h"
#include "schuler/core/fact.h"

#include <string>
#include <vector>

namespace schuler::app {

/// Puts what a run has found in the place of what it was asked to find, so that the settings repeat it.
void take_in_force(Config& config, const fusion::Findings& findings);

/// The settings that say what the data are, in the order of dataset.toml, each with its value in force.
[[nodiscard]] std::vector<Fact> facts_of(const ResultBundle& bundle);

/// "deg/s" of a key that ends so; empty where it names no unit.
[[nodiscard]] std::string unit_of_key(const std::string& key);

/// "0.12 +- 0.02 s", "\"frd\"": the value of a fact for people.
[[nodiscard]] std::string fact_text(const Fact& fact);

/// Neither a default nor a given value that is the default's anyway.
[[nodiscard]] bool is_news(const Fact& fact);

/// The facts that are given, stated or found and are news, a line each; `notes` adds the evidence.
[[nodiscard]] std::string facts_table(const std::vector<Fact>& facts, bool notes);

}  // namespace schuler::app
