// `schuler paper`.
#include "schuler/study/papers/papers.h"
#include "schuler/app/commands/builders.h"

namespace schuler::app {

void add_paper_command(std::vector<Command>& list) {
    using R = study::PaperRequest;
    OptionTable<R> t;
    t.add(argument(
        "PAPER", one_of<R>("paper", {"A", "B", "C", "D", "E"}, "letter of the paper", [](auto& r) -> auto& { return r.paper; })));
    Option<R> item = settings::text<R>("item", "a table or figure of the paper, or all", [](auto& r) -> auto& { return r.item; });
    item.spec.line.positional = true;
    item.spec.line.value_name = "ITEM";
    t.add(otherwise("list them", std::move(item)))
        .add(output_option<R>("folder of report.html, CSV files and summary.json", "none",
                              [](auto& r) -> auto& { return r.output; }))
        .add(lettered('n', written("RUNS", settings::integer<R>(
                                               "runs", 0, 100'000,
                                               "number of runs of an item that is a Monte Carlo campaign; 0: default of the item",
                                               [](auto& r) -> auto& { return r.runs; }))))
        .add(jobs_option<R>([](auto& r) -> auto& { return r.jobs; }))
        .add(seed_option<R>("seed of the first run", [](auto& r) -> auto& { return r.seed; }));
    list.push_back(
        command<R>("paper", "tables and figures of the five papers: computed values beside the printed ones, with the misprints",
                   "  schuler paper A                         the items of paper A\n"
                   "  schuler paper A figure-4.1.1            one item\n"
                   "  schuler paper D figure-5 -n 96 -o out/figure5   with plots, of 96 runs\n"
                   "  schuler paper C all -o out/paper-c      all items except Monte Carlo campaigns, one folder each\n"
                   "Exit status 1: a printed number is not reached, and no misprint explains it.",
                   std::move(t), one_json_document, true, study::make_paper));
}

}  // namespace schuler::app
