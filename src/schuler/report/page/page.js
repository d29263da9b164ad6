'use strict';
(() => {
const make = (name, attributes, text) => {
  const e = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const k in attributes) e.setAttribute(k, attributes[k]);
  if (text !== undefined) e.textContent = text;
  return e;
};
const numbers = text => text.split(' ').map(Number);
const clamp = (v, lo, hi) => Math.min(Math.max(v, lo), hi);
const unit = label => { const at = label.lastIndexOf(', '); return at < 0 ? '' : ' ' + label.slice(at + 2); };
const quantity = label => { const at = label.lastIndexOf(', '); return at < 0 ? label : label.slice(0, at); };

function readPanel(svg) {
  const [left, top, width, height] = numbers(svg.dataset.box);
  const base = numbers(svg.dataset.x).concat(numbers(svg.dataset.y));
  const ticks = svg.querySelector('.ticks');
  for (const title of svg.querySelectorAll('title')) {  // a native tooltip would cover ours
    if (title.parentNode === svg) { svg.setAttribute('aria-label', title.textContent); svg.removeAttribute('aria-labelledby');
      svg.setAttribute('aria-describedby', svg.querySelector('desc').id); }
    else title.parentNode.dataset.label = title.textContent;
    title.remove();
  }
  return {svg, left, top, width, height, base, view: base.slice(), ticks, ticks0: ticks.cloneNode(true),
    group: svg.querySelector('.curves'),
    time: !!svg.dataset.time, equal: !!svg.dataset.equal, log: !!svg.dataset.log, hidden: new Set(), curves: null,
    spans: [...svg.querySelectorAll('.span')], line: svg.appendChild(make(svg.dataset.equal ? 'circle' : 'path',
      {class: 'cursor hidden', r: 5})),
    legend: svg.closest('figure').querySelector('.legend')};
}

function readCurves(p) {
  const [x0, x1, y0, y1] = p.base;
  const ax = px => x0 + px / 100 / p.width * (x1 - x0), ay = px => y1 - px / 100 / p.height * (y1 - y0);
  return [...p.group.querySelectorAll('[data-k]')].map(path => {
    const runs = [];
    let run, x = 0, y = 0;
    for (const part of path.getAttribute('d').match(/[Ml][^Mlhz]*/g) || []) {
      const v = part.match(/-?\d+/g).map(Number);
      if (part[0] === 'M') { x = v[0]; y = v[1]; runs.push(run = [[x, y]]); }
      else for (let i = 0; i + 1 < v.length; i += 2) run.push([x += v[i], y += v[i + 1]]);
    }
    const c = {i: path.dataset.i, kind: path.dataset.k, name: path.dataset.n, clamp: !!path.dataset.clamp, x: [], y: [],
      lo: [], t: null};
    for (const r of runs) {
      const n = c.kind === 'band' ? r.length / 2 : r.length;
      for (let i = 0; i < n; i++) {
        c.x.push(ax(r[i][0])); c.y.push(ay(r[i][1]));
        c.lo.push(ay(r[c.kind === 'band' ? r.length - 1 - i : i][1]));
      }
    }
    if (path.dataset.t) { let t = 0; c.t = numbers(path.dataset.t).map((v, i) => i ? t += v / 1000 : t = v); }
    return c;
  });
}
const curvesOf = p => (p.curves = p.curves || readCurves(p)).filter(c => !p.hidden.has(c.i));

function firstAtOrAfter(a, v) {
  let lo = 0, hi = a.length;
  while (lo < hi) { const m = (lo + hi) >> 1; if (a[m] < v) lo = m + 1; else hi = m; }
  return lo;
}
function nearest(a, v) {
  const i = firstAtOrAfter(a, v);
  return i > 0 && (i === a.length || v - a[i - 1] < a[i] - v) ? i - 1 : i;
}

function tickValues(lo, hi, target, log) {
  const out = [];
  if (log) {
    const stride = Math.max(1, Math.ceil((hi - lo) / 6));
    for (let k = Math.floor(lo); k <= hi; k++) for (const m of hi - lo > 2 ? [1] : [1, 2, 5]) {
      const v = k + Math.log10(m);
      if (k % stride === 0 && v >= lo && v <= hi) out.push([v, String(Number((m * 10 ** k).toPrecision(6)))]);
    }
    return out;
  }
  const raw = (hi - lo) / target, power = Math.floor(Math.log10(raw)), m = raw / 10 ** power;
  const step = (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10) * 10 ** power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), plain = Math.max(Math.abs(lo), Math.abs(hi)) < 1e7 &&
    decimals < 6;
  const digits = clamp(Math.ceil(Math.log10(Math.max(Math.abs(lo), Math.abs(hi)) / step)) + 1, 6, 15);
  for (let k = Math.ceil(lo / step - 1e-9); k * step <= hi + 1e-9 * step && out.length < 100; k++) {
    const v = k * step;
    out.push([v, plain ? v.toFixed(decimals).replace(/^-(0(\.0*)?)$/, '$1') : String(Number(v.toPrecision(digits)))]);
  }
  return out;
}

const px = (p, x) => (x - p.view[0]) / (p.view[1] - p.view[0]) * p.width;
const py = (p, y) => (p.view[3] - y) / (p.view[3] - p.view[2]) * p.height;

function draw(p) {
  const [b0, b1, c0, c1] = p.base, [x0, x1, y0, y1] = p.view;
  const kx = (b1 - b0) / (x1 - x0), ky = (c1 - c0) / (y1 - y0);
  p.group.setAttribute('transform', `matrix(${kx / 100} 0 0 ${ky / 100} ${p.left + px(p, b0)} ${p.top + py(p, c1)})`);
  let free = 0;
  for (const g of p.spans) {
    const at = v => px(p, b0 + v / p.width * (b1 - b0));
    const a = clamp(at(+g.dataset.a), 0, p.width), b = clamp(at(+g.dataset.b), 0, p.width), text = g.querySelector('text');
    g.classList.toggle('hidden', !(b > a));
    g.querySelector('rect').setAttribute('x', p.left + a);
    g.querySelector('rect').setAttribute('width', b - a);
    const width = 6.2 * text.textContent.length, room = a >= free && a + width < p.width;
    if (room && b > a) free = a + width + 8;
    text.classList.toggle('hidden', !room);
    text.setAttribute('x', p.left + a);
  }
  const scale = p.svg.querySelector('.scale');
  if (p.view.every((v, i) => v === p.base[i])) {
    p.ticks.replaceChildren(...p.ticks0.cloneNode(true).childNodes);
    if (scale) scale.classList.remove('hidden');
    return;
  }
  if (scale) scale.classList.add('hidden');
  const parts = [];
  for (const [v, label] of tickValues(x0, x1, 10, false)) {
    const x = p.left + px(p, v);
    parts.push(make('path', {class: 'grid', d: `M${x} ${p.top}v${p.height}`}), make('text', {class: 'tx', x,
      y: p.top + p.height + 14}, label));
  }
  for (const [v, label] of tickValues(y0, y1, p.equal ? 10 * p.height / p.width : Math.max(2, Math.floor(p.height / 34)),
    p.log)) {
    const y = p.top + py(p, v);
    parts.push(make('path', {class: v === 0 && !p.log ? 'grid zero' : 'grid', d: `M${p.left} ${y}h${p.width}`}),
      make('text', {class: 'ty', x: p.left - 6, y: y + 4}, label));
  }
  p.ticks.replaceChildren(...parts);
}

function fitY(p) {
  if (p.svg.dataset.fixed) { p.view[2] = p.base[2]; p.view[3] = p.base[3]; return; }
  let lo = Infinity, hi = -Infinity;
  for (const c of curvesOf(p)) {
    const from = Math.max(0, firstAtOrAfter(c.x, p.view[0]) - 1), to = Math.min(c.x.length, firstAtOrAfter(c.x, p.view[1]) + 1);
    for (let i = from; i < to; i++) { lo = Math.min(lo, c.y[i], c.lo[i]); hi = Math.max(hi, c.y[i], c.lo[i]); }
  }
  if (!(hi >= lo)) { lo = p.base[2]; hi = p.base[3]; }
  const pad = Math.max(0.06 * (hi - lo), 1e-4 * (p.base[3] - p.base[2]));
  p.view[2] = lo - pad; p.view[3] = hi + pad;
}

function zoomX(source, x0, x1, y) {
  const [b0, b1] = source.base, least = (b1 - b0) / 2000;
  if (x1 - x0 < least) { const m = (x0 + x1) / 2; x0 = m - least / 2; x1 = m + least / 2; }
  for (const p of source.time ? panels.filter(q => q.time) : [source]) {
    if (x0 <= b0 && x1 >= b1 && !y) p.view = p.base.slice();
    else {
      p.view[0] = x0; p.view[1] = x1;
      if (p === source && y) { p.view[2] = y[0]; p.view[3] = y[1]; } else fitY(p);
    }
    draw(p);
  }
}
function zoomMap(p, x0, x1, y0, y1) {
  const k = Math.max((x1 - x0) / p.width, (y1 - y0) / p.height, (p.base[1] - p.base[0]) / p.width / 2000);
  const x = (x0 + x1) / 2, y = (y0 + y1) / 2;
  p.view = k * p.width >= p.base[1] - p.base[0] ? p.base.slice() : [x - k * p.width / 2, x + k * p.width / 2,
    y - k * p.height / 2, y + k * p.height / 2];
  draw(p);
}
function reset(p) { for (const q of p.time ? panels.filter(o => o.time) : [p]) { q.view = q.base.slice(); draw(q); } }
function zoomAbout(p, x, y, factor) {
  const [x0, x1, y0, y1] = p.view;
  if (p.equal) zoomMap(p, x + (x0 - x) * factor, x + (x1 - x) * factor, y + (y0 - y) * factor, y + (y1 - y) * factor);
  else zoomX(p, Math.max(p.base[0], x + (x0 - x) * factor), Math.min(p.base[1], x + (x1 - x) * factor));
}

const tip = document.createElement('div');
tip.className = 'tip hidden';
document.body.append(tip);
const fixed = (v, range) => v.toFixed(clamp(3 - Math.floor(Math.log10(range)), 0, 9)).replace(/^-(0(\.0*)?)$/, '$1');
function shown(p, c, v) {
  if (c.clamp && Math.min(p.base[3] - v, v - p.base[2]) < 5.01 / p.height * (p.base[3] - p.base[2]))
    return (v > (p.base[2] + p.base[3]) / 2 ? '≥ ' : '≤ ') + shown(p, {}, v);
  return p.log ? String(Number((10 ** v).toPrecision(4))) : fixed(v, p.view[3] - p.view[2]);
}
function row(p, c, text) {
  const e = document.createElement('div'), b = document.createElement('b'), button = p.legend.querySelector(`[data-i="${c.i}"]`);
  if (button) e.append(button.querySelector('svg').cloneNode(true));
  b.textContent = text;
  e.append(c.name, b);
  tip.append(e);
}
function place(p, x, y) {
  tip.classList.remove('hidden');
  const w = tip.offsetWidth, h = tip.offsetHeight;
  tip.style.left = (x + 16 + w > innerWidth ? x - 16 - w : x + 16) + 'px';
  tip.style.top = clamp(y + 14, 4, innerHeight - h - 4) + 'px';
}

function showTime(t) {
  for (const p of panels) {
    if (p.time) {
      const inside = t >= p.view[0] && t <= p.view[1];
      p.line.classList.toggle('hidden', !inside);
      if (inside) p.line.setAttribute('d', `M${p.left + px(p, t)} ${p.top}v${p.height}`);
    } else if (p.equal) {
      const c = curvesOf(p).find(o => o.t && o.kind === 'line');
      const i = c ? nearest(c.t, t) : -1;
      const inside = i >= 0 && i < c.x.length && c.x[i] >= p.view[0] && c.x[i] <= p.view[1] && c.y[i] >= p.view[2] &&
        c.y[i] <= p.view[3];
      p.line.classList.toggle('hidden', !inside);
      if (inside) { p.line.setAttribute('cx', p.left + px(p, c.x[i])); p.line.setAttribute('cy', p.top + py(p, c.y[i])); }
    }
  }
}
function hide() { tip.classList.add('hidden'); for (const p of panels) p.line.classList.add('hidden'); }

function pointAt(p, x, y, clientX, clientY) {
  tip.replaceChildren();
  const xl = p.svg.dataset.xl, yl = p.svg.dataset.yl, head = document.createElement('div');
  tip.append(head);
  if (p.equal) {
    let best = null, least = 40;
    for (const c of curvesOf(p)) for (let i = 0; i < c.x.length; i++) {
      const d = Math.hypot(px(p, c.x[i]) - px(p, x), py(p, c.y[i]) - py(p, y));
      if (d < least) { least = d; best = [c, i]; }
    }
    if (!best) { hide(); return; }
    const [c, i] = best, range = p.view[1] - p.view[0];
    row(p, c, c.t ? fixed(c.t[i], 100) + ' s' : '');
    head.textContent = `${quantity(xl)} ${fixed(c.x[i], range)}${unit(xl)}, ${quantity(yl)} ${fixed(c.y[i], range)}${unit(yl)}`;
    if (c.t) showTime(c.t[i]);
    p.line.classList.remove('hidden');
    p.line.setAttribute('cx', p.left + px(p, c.x[i])); p.line.setAttribute('cy', p.top + py(p, c.y[i]));
  } else {
    head.textContent = `${quantity(xl)} ${fixed(x, p.view[1] - p.view[0])}${unit(xl)}`;
    const reach = Math.max(25 * (p.view[1] - p.view[0]), 4 * (p.base[1] - p.base[0])) / p.width;
    for (const c of curvesOf(p)) {
      const i = nearest(c.x, x);
      if (i >= c.x.length || Math.abs(c.x[i] - x) > reach || (c.kind === 'dots' && Math.abs(c.x[i] - x) > reach / 3)) continue;
      row(p, c, (c.kind === 'band' ? shown(p, c, c.lo[i]) + ' to ' : '') + shown(p, c, c.y[i]) + unit(yl));
    }
    for (const g of p.spans) {
      const at = (x - p.base[0]) / (p.base[1] - p.base[0]) * p.width;
      if (at >= +g.dataset.a && at <= +g.dataset.b) { const e = document.createElement('div');
        e.textContent = g.dataset.label; tip.append(e); }
    }
    if (p.time) showTime(x);
    else { p.line.classList.remove('hidden'); p.line.setAttribute('d', `M${p.left + px(p, x)} ${p.top}v${p.height}`); }
  }
  p.at = [x, y];
  place(p, clientX, clientY);
}

function listen(p) {
  const svg = p.svg, xLimit = v => clamp(v, 0, p.width), yLimit = v => clamp(v, 0, p.height);
  const where = e => {
    const r = svg.getBoundingClientRect(), k = svg.viewBox.baseVal.width / r.width;
    const u = (e.clientX - r.left) * k - p.left, v = (e.clientY - r.top) * k - p.top;
    return {u, v, inside: u >= 0 && u <= p.width && v >= 0 && v <= p.height,
      x: p.view[0] + xLimit(u) / p.width * (p.view[1] - p.view[0]),
        y: p.view[3] - yLimit(v) / p.height * (p.view[3] - p.view[2])};
  };
  let from = null, box = null;
  const stop = () => { from = null; if (box) box.remove(); box = null; };
  svg.addEventListener('pointerdown', e => {
    const w = where(e);
    if (e.button !== 0 || e.pointerType === 'touch' || !w.inside) return;
    from = w;
    svg.setPointerCapture(e.pointerId);
  });
  svg.addEventListener('pointermove', e => {
    const w = where(e);
    if (!from) { if (w.inside) pointAt(p, w.x, w.y, e.clientX, e.clientY); else hide(); return; }
    const tall = p.equal || Math.abs(w.v - from.v) > 18, u = xLimit(w.u), v = yLimit(w.v);
    if (Math.abs(u - from.u) < 6) return;
    if (!box) { hide(); box = svg.appendChild(make('rect', {class: 'zoom'})); }
    box.setAttribute('x', p.left + Math.min(u, from.u)); box.setAttribute('width', Math.abs(u - from.u));
    box.setAttribute('y', p.top + (tall ? Math.min(v, from.v) : 0));
    box.setAttribute('height', tall ? Math.abs(v - from.v) : p.height);
  });
  svg.addEventListener('pointerup', e => {
    if (from && box) {
      const w = where(e), x = [from.x, w.x].sort((a, b) => a - b), y = [from.y, w.y].sort((a, b) => a - b);
      if (p.equal) zoomMap(p, ...x, ...y); else zoomX(p, ...x, Math.abs(w.v - from.v) > 18 ? y : null);
    }
    stop();
  });
  svg.addEventListener('pointercancel', stop);
  svg.addEventListener('pointerleave', () => { if (!from) hide(); });
  svg.addEventListener('dblclick', () => reset(p));
  svg.addEventListener('wheel', e => {
    const w = where(e);
    if (!(e.ctrlKey || e.shiftKey) || !w.inside) return;
    e.preventDefault();
    zoomAbout(p, w.x, w.y, (e.deltaY || e.deltaX) > 0 ? 1.25 : 0.8);
  }, {passive: false});
  svg.addEventListener('keydown', e => {
    const [x0, x1, y0, y1] = p.view, at = p.at || [(x0 + x1) / 2, (y0 + y1) / 2], step = (x1 - x0) / 100;
    if (e.key === 'ArrowLeft' || e.key === 'ArrowRight') {
      const x = clamp(at[0] + (e.key === 'ArrowLeft' ? -step : step), x0, x1), r = svg.getBoundingClientRect();
      if (!p.equal) pointAt(p, x, at[1], r.left + (p.left + px(p, x)) * r.width / svg.viewBox.baseVal.width, r.top + 20);
    } else if (e.key === '+' || e.key === '-') zoomAbout(p, clamp(at[0], x0, x1), clamp(at[1], y0, y1),
      e.key === '+' ? 0.8 : 1.25);
    else if (e.key === 'Escape' || e.key === '0') { reset(p); hide(); }
    else return;
    e.preventDefault();
  });
  svg.setAttribute('tabindex', '0');
  for (const button of p.legend.querySelectorAll('button')) button.addEventListener('click', () => {
    const i = button.dataset.i, hidden = !p.hidden.has(i);
    if (hidden) p.hidden.add(i); else p.hidden.delete(i);
    button.setAttribute('aria-pressed', String(!hidden));
    for (const path of p.group.querySelectorAll(`[data-i="${i}"]`)) path.classList.toggle('hidden', hidden);
  });
}

const panels = [...document.querySelectorAll('svg[data-box]')].map(readPanel);
panels.forEach(listen);
document.documentElement.classList.add('js');
const hint = document.querySelector('.hint');
if (hint && panels.length) hint.classList.remove('hidden');
})();
