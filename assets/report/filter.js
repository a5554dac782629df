// The filter of a table: words, and comparisons with a column.

export const isNumber = (text) => text !== "" && (Number.isFinite(Number(text)) || text === "inf" || text === "-inf");
export const value = (text) => (text === "inf" ? Infinity : text === "-inf" ? -Infinity : Number(text));

const SIGNS = "<=|>=|!=|==|=|<|>|≤|≥|≠";
const ALIAS = { "==": "=", "≤": "<=", "≥": ">=", "≠": "!=" };

/** Words of the filter; quotes hold words with spaces together, and spaces around a sign belong to the comparison. */
function parts(filter) {
  const joined = filter.replace(new RegExp(`\\s*(${SIGNS})\\s*`, "g"), "$1");
  return joined.match(/(?:"[^"]*"?|[^\s"])+/g) ?? [];
}

/**
 * What a filter asks: {test(row), complaints}. A word is looked for in every column; `alpha=0.1`, `brdf != ggx`, `rmse <= 0.5` compare one
 * column. What cannot be understood hides no row and is a complaint, a sentence.
 */
export function parseFilter(columns, filter) {
  const complaints = [], tests = [];
  for (const part of parts(filter)) {
    const [, name, sign, wanted] = part.match(new RegExp(`^(.*?)(${SIGNS})(.*)$`)) ?? [];
    if (sign === undefined || part.startsWith('"')) {
      const word = part.replaceAll('"', "").toLowerCase();
      tests.push((row) => row.some((field) => field.toLowerCase().includes(word)));
      continue;
    }
    const test = wanted === "" && name !== "" ? `“${name} ${sign}” says no ${sign === "=" || sign === "!=" ? "value; \"\" stands for an empty field" : "number"}` : comparison(columns, name, ALIAS[sign] ?? sign, wanted.replaceAll('"', ""));
    if (typeof test === "string") complaints.push(test);
    else tests.push(test);
  }
  return { test: (row) => tests.every((test) => test(row)), complaints };
}

/** A test of a row, or why there is none. */
function comparison(columns, name, sign, wanted) {
  const place = columns.findIndex((column) => column.toLowerCase() === name.toLowerCase());
  if (name === "") return `“${sign}${wanted}” names no column`;
  if (place < 0) return `no column “${name}”${nearest(columns, name)}`;
  if (wanted === "" && sign !== "=" && sign !== "!=") return `“${name} ${sign}” says no number`;
  const text = wanted.toLowerCase(), equals = (field) => field.toLowerCase() === text || (isNumber(field) && isNumber(wanted) && value(field) === value(wanted));
  if (sign === "=") return (row) => equals(row[place]);
  if (sign === "!=") return (row) => !equals(row[place]);
  if (!isNumber(wanted)) return `“${wanted}” is no number, which ${sign} needs`;
  const limit = value(wanted), holds = { "<": (x) => x < limit, ">": (x) => x > limit, "<=": (x) => x <= limit, ">=": (x) => x >= limit }[sign];
  return (row) => isNumber(row[place]) && holds(value(row[place]));
}

/** The column that was perhaps meant. */
function nearest(columns, name) {
  const found = columns.find((column) => column.toLowerCase().includes(name.toLowerCase()) || name.toLowerCase().includes(column.toLowerCase()));
  return found ? `; perhaps “${found}”` : "";
}
