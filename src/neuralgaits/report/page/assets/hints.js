// Says of a table or figure that it can be moved sideways, as long as some of it is cut; enlarges
// figures, and sorts them into columns of one height; lets commands break between their words only.
"use strict";

function watchWidth(box) {
  const hint = box.previousElementSibling;
  const look = () => {
    const hidden = box.scrollWidth - box.clientWidth;
    hint.hidden = hidden <= 1;
    box.classList.toggle("more", box.scrollLeft < hidden - 1);
  };
  const sizes = new ResizeObserver(look);
  sizes.observe(box);
  sizes.observe(box.firstElementChild);
  box.addEventListener("scroll", look, { passive: true });
}

function addEnlarge(figure) {
  const box = figure.querySelector(".scroll"), button = document.createElement("button");
  const say = (large) => {
    button.textContent = large ? "Smaller" : "Enlarge";
    button.setAttribute("aria-label", `${button.textContent}: ${box.getAttribute("aria-label")}`);
  };
  button.type = "button"; button.className = "enlarge";
  button.addEventListener("click", () => {
    say(box.classList.toggle("large"));
    // A figure of another size has another place on the page. Its button is at its top.
    const fits = figure.offsetHeight < window.innerHeight;
    figure.scrollIntoView({ block: fits ? "nearest" : "start" });
  });
  figure.prepend(button);
  say(false);
}

// Of all ways to part figures between two columns, the one with the least gap below, and with few
// figures out of their order: a pair that changes places counts as 12 pixels of gap.
function parted(heights) {
  const all = heights.reduce((sum, one) => sum + one, 0);
  let best = [], least = Infinity;
  // The first figure stays where it is: in the first column. A bit says that one is in the second.
  for (let bits = 0; bits < 2 ** heights.length; bits += 2) {
    let second = 0, count = 0, cost = 0;
    heights.forEach((height, i) => {
      if (bits >> i & 1) { second += height; count += 1; } else cost += 12 * count;
    });
    cost += Math.abs(all - 2 * second);
    if (cost < least) [best, least] = [heights.map((_, i) => bits >> i & 1), cost];
  }
  return best;
}

function fillColumns(box) {
  const figures = [...box.children];
  // On a narrow page there is one column, and many figures would have too many ways.
  if (figures.every((one) => one.offsetLeft === figures[0].offsetLeft) || figures.length > 16) return;
  const sides = parted(figures.map((one) => one.offsetHeight));
  box.append(...[0, 1].flatMap((side) => figures.filter((_, i) => sides[i] === side)));
}

function keepWords(code) {
  const words = code.textContent.split(/(\s+)/).map((word, i) => {
    if (i % 2) return word;
    const kept = document.createElement("span");
    kept.className = "word"; kept.textContent = word;
    return kept;
  });
  code.replaceChildren(...words);
}

document.querySelectorAll(".scroll").forEach(watchWidth);
document.querySelectorAll("figure").forEach(addEnlarge);
document.querySelectorAll("pre code, td code").forEach(keepWords);
// Not before, as figures have no height until they are there.
window.addEventListener("load", () => document.querySelectorAll(".figures").forEach(fillColumns));
