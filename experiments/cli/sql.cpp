// misbench sql: any question to a store. Rows are written as they are found, however many.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "experiments/cli/output.h"
#include "experiments/cli/verbs.h"
#include "experiments/report/numbers.h"
#include "experiments/report/table_formats.h"
#include "results/query.h"

namespace misbench {
namespace {

constexpr std::size_t kBufferBytes = 1 << 16;
// Rows that the widths of text columns are taken from.
constexpr std::size_t kRowsForWidths = 1000;

nlohmann::json to_json(const QueryValue& value) {
    return std::visit([](const auto& v) { return nlohmann::json(v); }, value);
}

// Numbers in full precision, NULL as nothing.
std::string to_plain(const QueryValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (std::holds_alternative<std::nullptr_t>(value)) return "";
    const auto* real = std::get_if<double>(&value);
    if (real != nullptr && std::isinf(*real)) return *real > 0 ? "inf" : "-inf";
    return to_json(value).dump();
}

std::vector<std::string> to_plain(const std::vector<QueryValue>& row) {
    std::vector<std::string> texts;
    for (const QueryValue& value : row) texts.push_back(to_plain(value));
    return texts;
}

class Writer {
 public:
    void write(const std::string& text) {
        buffer_ += text;
        if (buffer_.size() >= kBufferBytes) flush();
    }
    void flush() {
        print_result(buffer_);
        buffer_.clear();
    }

 private:
    std::string buffer_;
};

std::string joined(const std::vector<std::string>& texts, std::string_view before,
                   std::string_view between, std::string_view after, auto escape) {
    std::string line(before);
    for (std::size_t i = 0; i < texts.size(); ++i) {
        if (i > 0) line += between;
        line += escape(texts[i]);
    }
    return line.append(after).append("\n");
}

void write_csv(Query& query, Writer& out) {
    out.write(joined(query.columns(), "", ",", "", escape_csv));
    std::vector<QueryValue> row;
    while (query.next(row)) out.write(joined(to_plain(row), "", ",", "", escape_csv));
}

void write_markdown(Query& query, Writer& out) {
    out.write(joined(query.columns(), "| ", " | ", " |", escape_markdown));
    out.write(joined(query.columns(), "|", "|", "|", [](const std::string&) { return "---"; }));
    std::vector<QueryValue> row;
    while (query.next(row)) out.write(joined(to_plain(row), "| ", " | ", " |", escape_markdown));
}

void write_json(Query& query, Writer& out) {
    out.write("[");
    const char* separator = "\n";
    std::vector<QueryValue> row;
    while (query.next(row)) {
        nlohmann::ordered_json object;
        for (std::size_t c = 0; c < row.size(); ++c) object[query.columns()[c]] = to_json(row[c]);
        out.write(separator + object.dump());
        separator = ",\n";
    }
    out.write("\n]\n");
}

void write_text(Query& query, Writer& out) {
    std::vector<std::vector<std::string>> first{query.columns()};
    std::vector<QueryValue> row;
    while (first.size() <= kRowsForWidths && query.next(row)) first.push_back(to_plain(row));
    std::vector<std::size_t> widths(query.columns().size());
    for (const auto& texts : first) {
        for (std::size_t c = 0; c < texts.size(); ++c) {
            widths[c] = std::max(widths[c], display_width(texts[c]));
        }
    }
    const auto write = [&](const std::vector<std::string>& texts) {
        std::string line;
        for (std::size_t c = 0; c < texts.size(); ++c) line += padded(texts[c], widths[c] + 2);
        line.erase(line.find_last_not_of(' ') + 1);
        out.write(line + "\n");
    };
    for (const auto& texts : first) write(texts);
    while (query.next(row)) write(to_plain(row));
}

}  // namespace

int sql_verb(const SqlOptions& options) {
    if (options.query.empty()) {
        print_result(documented_tables(options.store));
        return 0;
    }
    Query query(options.store, options.query);
    Writer out;
    if (options.format == "csv") {
        write_csv(query, out);
    } else if (options.format == "json") {
        write_json(query, out);
    } else if (options.format == "markdown") {
        write_markdown(query, out);
    } else {
        write_text(query, out);
    }
    out.flush();
    return 0;
}

}  // namespace misbench
