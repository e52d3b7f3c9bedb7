// SPDX-License-Identifier: Apache-2.0
// The language of the page. English stands in the page itself and is the key of each table (words_de.js). Shown is
// the language of `?lang=`, or the first of the browser's that there is; what the rig says is English.
'use strict';

const Words = {
  tables: { en: {}, de: words_de },
  asked: [new URLSearchParams(location.search).get('lang'), ...navigator.languages].map(one => (one || '').slice(0, 2)),
};
Words.language = Words.asked.find(one => Words.tables[one]) || 'en';
Words.table = Words.tables[Words.language];

// Of a text, or as the tag of a template, whose values are {0}, {1}, ... in the tables.
function tr(text, ...values) {
  const key = typeof text === 'string' ? text : text.reduce((all, part, i) => `${all}{${i - 1}}${part}`);
  return (Words.table[key] || key).replace(/\{(\d)\}/g, (all, i) => i in values ? values[i] : all);
}

// What stands in index.html.
document.documentElement.lang = Words.language;
const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
while (texts.nextNode()) {
  const node = texts.currentNode, text = node.data.trim();
  if (text) node.data = node.data.replace(text, () => tr(text));
}
for (const name of ['aria-label', 'title', 'placeholder', 'alt'])
  for (const node of document.querySelectorAll(`[${name}]`)) node.setAttribute(name, tr(node.getAttribute(name)));
