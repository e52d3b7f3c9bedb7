// SPDX-License-Identifier: Apache-2.0
// Shared by all of the page: the last state received, elements, and requests for changes.
'use strict';

const state = {};
const el = id => document.getElementById(id);

function make(tag, fields, ...children) {
  const node = document.createElement(tag);
  for (const [key, value] of Object.entries(fields || {}))
    if (key.startsWith('on')) node.addEventListener(key.slice(2), value);
    else if (key in node && key !== 'list') node[key] = value;
    else node.setAttribute(key, value);
  node.append(...children);
  return node;
}
function set(node, key, value) { if (node[key] !== value) node[key] = value; }
// A control that is being used keeps what the user does.
function setValue(node, value) { if (document.activeElement !== node) set(node, 'value', String(value)); }

let message_timer = 0;
function tell(text) {
  el('message').textContent = text;
  el('message').hidden = !text;
  clearTimeout(message_timer);
  if (text) message_timer = setTimeout(() => tell(''), 8000);
}

async function ask(method, path, body, type) {
  try {
    const answer = await fetch('/api/v1/' + path, {
      method, body: type ? body : JSON.stringify(body || {}),
      headers: { 'Content-Type': type || 'application/json' } });
    if (answer.ok) return true;
    tell((await answer.json()).error || `The rig refused this change (HTTP status ${answer.status}).`);
  } catch (error) {
    tell('The rig does not answer: check that mixrig runs and that the network reaches it.');
  }
  return false;
}
// While one change is under way only the newest of those that follow is kept.
const waiting = new Map();
async function askNewest(key, method, path, body) {
  if (waiting.has(key)) { waiting.set(key, [method, path, body]); return; }
  waiting.set(key, null);
  await ask(method, path, body);
  const next = waiting.get(key);
  waiting.delete(key);
  if (next) await askNewest(key, ...next);
}
const thing_path = (kind, name) => `${kind}/${encodeURIComponent(name)}`;
