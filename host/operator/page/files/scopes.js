// SPDX-License-Identifier: Apache-2.0
// What a camera operator reads a picture by, computed in this browser from the picture that it shows: false
// colour, zebra, focus peaking, frame guides, waveform, histogram. The matte in a corner is a picture of the rig.
'use strict';

// Bands of luma, percent: what lies below `to` has this colour; without one it stays grey.
const bands = [
  { to: 2, colour: [140, 60, 200], name: 'below 2 %: black' },
  { to: 10, colour: [40, 90, 230], name: '2 to 10 %: deep shadow' },
  { to: 38 },
  { to: 48, colour: [40, 170, 70], name: '38 to 48 %: middle grey' },
  { to: 52 },
  { to: 60, colour: [240, 150, 180], name: '52 to 60 %: light skin' },
  { to: 95 },
  { to: 99, colour: [245, 225, 60], name: '95 to 99 %: nearly clipped' },
  { to: 101, colour: [230, 40, 30], name: 'above 99 %: clipped' },
];
const zebra_from = 95, peak_from = 48, kept_keys = ['overlay', 'guides', 'waveform', 'histogram', 'inset'];
const luma = (d, i) => (0.2126 * d[i] + 0.7152 * d[i + 1] + 0.0722 * d[i + 2]) / 2.55;   // percent, Rec. 709

const Paint = {
  // Each gets the pixels of the picture and of the overlay, which is transparent.
  false(from, to) {
    for (let i = 0; i < from.length; i += 4) {
      const y = luma(from, i), band = bands.find(b => y < b.to), grey = 2.55 * y;
      const [r, g, b] = band.colour || [grey, grey, grey];
      to[i] = r; to[i + 1] = g; to[i + 2] = b; to[i + 3] = 255;
    }
  },
  zebra(from, to, width) {
    for (let i = 0, p = 0; i < from.length; i += 4, ++p) {
      if (luma(from, i) < zebra_from) continue;
      const dark = ((p % width) + Math.floor(p / width)) % 8 < 4;
      to[i] = to[i + 1] = to[i + 2] = dark ? 0 : 255;
      to[i + 3] = 220;
    }
  },
  // Where neighbours differ much, across or down.
  peaking(from, to, width) {
    const row = 4 * width;
    for (let i = row; i + row < from.length; i += 4) {
      const column = (i % row) / 4, at = i + 1;   // green has most of the detail
      if (column === 0 || column === width - 1) continue;
      const across = from[at + 4] - from[at - 4], down = from[at + row] - from[at - row];
      if (Math.abs(across) + Math.abs(down) < peak_from) continue;
      to[i] = 255; to[i + 1] = 40; to[i + 2] = 220; to[i + 3] = 255;
    }
  },
};

function drawGuides(g, width, height, kind) {
  const line = (x0, y0, x1, y1) => { g.beginPath(); g.moveTo(x0, y0); g.lineTo(x1, y1); g.stroke(); };
  const box = (w, h) => {
    for (const [colour, grow] of [['#000', 1], ['#fff', 0]]) {
      g.strokeStyle = colour;
      g.strokeRect((width - w) / 2 - grow, (height - h) / 2 - grow, w + 2 * grow, h + 2 * grow);
    }
  };
  g.lineWidth = 1;
  if (kind === 'thirds') {
    g.strokeStyle = 'rgba(255, 255, 255, .8)';
    for (const k of [1, 2]) {
      line(width * k / 3, 0, width * k / 3, height);
      line(0, height * k / 3, width, height * k / 3);
    }
    line(width / 2 - 12, height / 2, width / 2 + 12, height / 2);
    line(width / 2, height / 2 - 12, width / 2, height / 2 + 12);
    return;
  }
  if (kind === 'safe') { box(0.93 * width, 0.93 * height); box(0.9 * width, 0.9 * height); return; }
  const aspect = Number(kind), h = Math.min(height, width / aspect);
  box(h * aspect - 2, h - 2);
}

// Luma over the picture's columns; brighter where more pixels have it.
function drawWaveform(canvas, pixels, width) {
  const g = canvas.getContext('2d'), { width: w, height: h } = canvas, counts = new Uint16Array(w * h);
  for (let i = 0, p = 0; i < pixels.length; i += 4, ++p) {
    const x = Math.floor((p % width) * w / width), y = Math.round((h - 1) * (1 - luma(pixels, i) / 100));
    ++counts[y * w + x];
  }
  const image = g.createImageData(w, h), per_column = pixels.length / 4 / w;
  for (let i = 0; i < counts.length; ++i) {
    const v = Math.min(255, 40 * Math.sqrt(counts[i]) * Math.sqrt(400 / per_column));
    image.data.set([v * 0.5, v, v * 0.6, 255], 4 * i);
  }
  g.putImageData(image, 0, 0);
  g.strokeStyle = 'rgba(255, 255, 255, .35)';
  for (const percent of [0, 25, 50, 75, 100]) {
    const y = Math.round((h - 1) * (1 - percent / 100)) + (percent ? 0.5 : -0.5);
    g.beginPath(); g.moveTo(0, y); g.lineTo(w, y); g.stroke();
  }
}

function drawHistogram(canvas, pixels) {
  const g = canvas.getContext('2d'), { width: w, height: h } = canvas, counts = [0, 1, 2].map(() => new Uint32Array(256));
  for (let i = 0; i < pixels.length; i += 4) for (const c of [0, 1, 2]) ++counts[c][pixels[i + c]];
  g.globalCompositeOperation = 'source-over';
  g.fillStyle = '#000';
  g.fillRect(0, 0, w, h);
  g.globalCompositeOperation = 'lighter';
  // The bars of the ends may be far above all others.
  const most = Math.max(...counts.flatMap(one => [...one.subarray(1, 255)]), 1);
  counts.forEach((one, c) => {
    g.fillStyle = ['#d03030', '#30a040', '#4060e0'][c];
    one.forEach((n, v) => { const tall = Math.min(h, h * n / most); g.fillRect(v * w / 256, h - tall, w / 256 + .5, tall); });
  });
}

const Scopes = {
  work: document.createElement('canvas'), drawn: '', inset_url: '',
  on: Object.assign({ overlay: '', guides: '', waveform: false, histogram: false, inset: false },
    JSON.parse(localStorage.getItem('scopes') || '{}')),

  choose(key, value) {
    this.on[key] = value;
    localStorage.setItem('scopes', JSON.stringify(this.on));
    this.show();
  },
  show() {
    for (const key of kept_keys) {
      const node = el('scope-' + key);
      if (node.type === 'checkbox') node.checked = this.on[key]; else node.value = this.on[key];
    }
    for (const key of ['waveform', 'histogram']) el(key + '-figure').hidden = !this.on[key];
    el('inset').hidden = !this.on.inset;
    el('legend').hidden = this.on.overlay !== 'false';
    this.drawn = '';
    this.look();
  },
  // Ten times a second at most, and only for a picture that has not been looked at.
  look() {
    const canvas = el('canvas'), now = `${Picture.view} ${Picture.frame}`;
    if (now === this.drawn || !Picture.frame) return;
    this.drawn = now;
    const { overlay, guides, waveform, histogram } = this.on, over = el('overlay');
    over.hidden = !overlay && !guides;
    el('exposure').hidden = !overlay && !waveform && !histogram;
    if (over.hidden && el('exposure').hidden) return;
    const scale = Math.min(1, 640 / canvas.width);
    const width = Math.round(canvas.width * scale), height = Math.round(canvas.height * scale);
    this.work.width = over.width = width;
    this.work.height = over.height = height;
    const work = this.work.getContext('2d', { willReadFrequently: true }), g = over.getContext('2d');
    work.drawImage(canvas, 0, 0, width, height);
    const pixels = work.getImageData(0, 0, width, height).data;
    if (Paint[overlay]) {
      const image = g.createImageData(width, height);
      Paint[overlay](pixels, image.data, width);
      g.putImageData(image, 0, 0);
    }
    if (guides) drawGuides(g, width, height, guides);
    if (waveform) drawWaveform(el('waveform'), pixels, width);
    if (histogram) drawHistogram(el('histogram'), pixels);
    this.tell(pixels);
  },
  tell(pixels) {
    let clipped = 0, black = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      const y = luma(pixels, i);
      if (y > 99) ++clipped; else if (y < 2) ++black;
    }
    const percent = n => (400 * n / pixels.length).toFixed(1);
    el('exposure').textContent = tr`${percent(clipped)} % clipped, ${percent(black)} % black`;
  },
  async fetchInset() {
    if (!this.on.inset || document.hidden) return;
    const answer = await fetch('/api/v1/picture/matte.jpg').catch(() => null);
    if (!answer || !answer.ok) return;
    URL.revokeObjectURL(this.inset_url);
    this.inset_url = el('inset').src = URL.createObjectURL(await answer.blob());
  },
};
for (const key of kept_keys)
  el('scope-' + key).addEventListener('change', e => Scopes.choose(key, e.target.type === 'checkbox' ? e.target.checked : e.target.value));
for (const band of bands.filter(b => b.colour))
  el('legend').append(make('span', {}, make('i', { style: `background: rgb(${band.colour})` }), tr(band.name)));
Scopes.show();
setInterval(() => Scopes.look(), 100);
(async () => { for (;;) { await Scopes.fetchInset(); await new Promise(done => setTimeout(done, 250)); } })();
