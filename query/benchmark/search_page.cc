#include "query/benchmark/search_page.h"

#include <fmt/format.h>

#include "report/curve_chart.h"
#include "report/html_text.h"
#include "report/page.h"

namespace freshet::query {
namespace {

// "246,477"
std::string grouped(std::size_t number) {
  std::string digits = std::to_string(number);
  for (std::size_t at = digits.size(); at > 3; at -= 3) digits.insert(at - 3, 1, ',');
  return digits;
}

std::string figure(double value) {
  if (value >= 100) return fmt::format("{:.0f}", value);
  if (value >= 10) return fmt::format("{:.1f}", value);
  return fmt::format("{:.2f}", value);
}

report::CurveChart chart_of(const SearchReport& report, bool near_one) {
  report::CurveChart chart;
  chart.title = near_one ? "The same from a recall@100 of 0.9 up"
                         : "Milliseconds per piece, one core, and what is found";
  chart.x.title = "recall@100";
  chart.y.title = "ms per piece, one core, median";
  chart.y.logarithmic = true;
  if (near_one) {
    chart.x.min = 0.9;
    chart.x.max = 1;
  }
  for (const IndexResult& index : report.indexes) {
    // Also those without a result, so that each index keeps its colour from page to page.
    report::ChartSeries series{index.name, {}};
    if (index.rows < report.rows && !index.settings.empty())
      series.name += fmt::format(" ({} patches)", grouped(index.rows));
    if (index.name == "exact") series.line = report::ChartLine::kLevel;
    for (const SettingResult& setting : index.settings)
      series.points.push_back({setting.recall.at_100, setting.times.median_ms, setting.name});
    chart.series.push_back(std::move(series));
  }
  return chart;
}

std::string cell(const std::string& text) { return "<td class=\"n\">" + text + "</td>"; }

std::string result_table(const SearchReport& report) {
  std::string table =
      "<div class=\"wide\"><table>\n<thead><tr><th>index</th><th>setting</th><th>patches</th>"
      "<th>build, s</th><th>MB</th><th>median ms</th><th>p99 ms</th><th>ms, all threads</th>"
      "<th>recall@1</th><th>@10</th><th>@100</th><th>worst</th><th>energy</th><th>pieces</th></tr></thead>\n"
      "<tbody>\n";
  for (const IndexResult& index : report.indexes) {
    for (std::size_t i = 0; i < index.settings.size(); ++i) {
      const SettingResult& setting = index.settings[i];
      table += i == 0 ? "<tr class=\"first\">" : "<tr>";
      table += fmt::format("<th scope=\"row\">{}</th><td>{}</td>",
                           i == 0 ? report::html_text(index.name) : "", report::html_text(setting.name));
      if (i == 0)
        table += cell(grouped(index.rows)) +
                 cell(figure(index.build_seconds) +
                      (index.projected_build_seconds > 0
                           ? fmt::format(" <small>(all: some {:.0f})</small>", index.projected_build_seconds)
                           : "")) +
                 cell(figure(static_cast<double>(index.bytes) / 1e6));
      else
        table += "<td></td><td></td><td></td>";
      table += cell(figure(setting.times.median_ms)) + cell(figure(setting.times.p99_ms)) +
               cell(figure(setting.times.all_threads_ms)) + cell(fmt::format("{:.3f}", setting.recall.at_1)) +
               cell(fmt::format("{:.3f}", setting.recall.at_10)) +
               cell(fmt::format("{:.3f}", setting.recall.at_100)) +
               cell(fmt::format("{:.2f}", setting.recall.worst)) +
               cell(setting.energy_loss ? fmt::format("{:+.2f}%", 100 * *setting.energy_loss) : "-") +
               cell(std::to_string(setting.pieces)) + "</tr>\n";
    }
  }
  return table + "</tbody>\n</table></div>\n";
}

std::string filter_table(const SearchReport& report) {
  std::string rows;
  for (const IndexResult& index : report.indexes)
    for (std::size_t i = 0; i < index.filters.size(); ++i) {
      const FilterResult& filter = index.filters[i];
      rows += i == 0 ? "<tr class=\"first\">" : "<tr>";
      rows += fmt::format("<th scope=\"row\">{}</th><td>{}</td><td>{}</td>",
                          i == 0 ? report::html_text(index.name) : "", report::html_text(filter.setting),
                          report::html_text(filter.condition)) +
              cell(fmt::format("{:.1f}%", 100 * filter.admitted)) + cell(figure(filter.times.median_ms)) +
              cell(figure(filter.times.p99_ms)) + cell(fmt::format("{:.3f}", filter.recall)) +
              cell(std::to_string(filter.short_of)) + "</tr>\n";
    }
  if (rows.empty()) return {};
  return "<h2>With conditions</h2>\n<p>Each index at its first setting that finds nine tenths, else at its "
         "most "
         "thorough. Recall is against the exact answer under the same condition; short: pieces that got "
         "fewer "
         "patches than there are.</p>\n"
         "<div class=\"wide\"><table>\n<thead><tr><th>index</th><th>setting</th><th>condition</th>"
         "<th>admitted</th><th>median ms</th><th>p99 ms</th><th>recall@100</th><th>short</th></tr></thead>\n"
         "<tbody>\n" +
         rows + "</tbody>\n</table></div>\n";
}

// clang-format off
constexpr std::string_view kStyle =
#include "embedded/search_page.html"
    ;
// clang-format on

}  // namespace

std::string search_page(const SearchReport& report) {
  std::string page(kStyle);
  std::string pictures;
  for (std::size_t i = 0; i < report.pictures.size(); ++i)
    pictures += fmt::format("{}{} ({} pieces)", i == 0 ? "" : ", ", report::html_text(report.pictures[i]),
                            report.picture_pieces[i]);
  page += fmt::format(
      "<p>{} patches of {} clips{}, {} words. {} pieces of {}.</p>\n", grouped(report.patches), report.clips,
      report.rows == report.patches ? std::string()
                                    : fmt::format(", searched among {} of them", grouped(report.rows)),
      report.words, report.pieces,
      report.held_out.empty()
          ? pictures
          : fmt::format("the average image of {}, whose own patches are left out", pictures));
  if (const std::string text = verdict(report); !text.empty())
    page += "<p>" + report::html_text(text) + "</p>\n";
  page += report::to_svg(chart_of(report, false)) + report::to_svg(chart_of(report, true));
  page +=
      "<p class=\"faint\">Lower is faster, further right finds more. The dashed line is the exact index, "
      "which "
      "finds all.</p>\n<h2>Every setting</h2>\n";
  page += result_table(report);
  page += fmt::format(
      "<p class=\"faint\">Build, median and p99: CPU time of one core, pieces asked one by one. All threads: "
      "wall "
      "clock, per piece of a batch. MB: memory that the built index holds. Recall counts a patch that scores "
      "as well "
      "as the last of the exact answer's; worst: recall@100 of one piece. {}Exact answers of {} pieces "
      "compared "
      "with brute force, {} wrong.</p>\n",
      report.labelled.empty()
          ? std::string()
          : fmt::format(
                "Energy: of {} pieces of {} labelled with these candidates, above that with exact ones. ",
                report.labelled_pieces, report::html_text(report.labelled)),
      report.checked, report.wrong);
  page += filter_table(report);
  page += "<h2>The indexes</h2>\n<dl>\n";
  for (const IndexResult& index : report.indexes) {
    page += fmt::format("<dt>{}</dt><dd>{}", report::html_text(index.name), report::html_text(index.what));
    if (!index.skipped.empty()) page += fmt::format(". Not measured: {}", report::html_text(index.skipped));
    if (!index.package.empty())
      page += fmt::format(" (install the package {} and build again)", report::html_text(index.package));
    if (index.from_store) page += ". Loaded from the store";
    if (index.projected_build_seconds > 0)
      page += fmt::format(". Built of {} patches, as all would take some {:.0f} s, or too much memory",
                          grouped(index.rows), index.projected_build_seconds);
    page += "</dd>\n";
  }
  page += fmt::format(
      "</dl>\n<h2>Machine and limits</h2>\n<p>{}. At most {:g} s of one core to build an index, {:g} s to "
      "ask "
      "with one setting.</p>\n",
      report::html_text(to_string(report.machine)), report.build_limit_s, report.setting_limit_s);
  return report::page_html("Candidate search in " + report.store, page);
}

}  // namespace freshet::query
