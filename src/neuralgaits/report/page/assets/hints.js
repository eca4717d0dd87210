// Says of a table or figure that it can be moved sideways, as long as some of it is cut; enlarges
// figures; and lets commands break between their words only.
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

const narrow = window.matchMedia("(max-width: 600px)");

function addEnlarge(figure) {
  const box = figure.querySelector(".scroll"), button = document.createElement("button");
  const turn = () => {
    const large = box.classList.toggle("large");
    button.textContent = large ? "Smaller" : "Enlarge";
    button.setAttribute("aria-label", `${button.textContent}: ${box.getAttribute("aria-label")}`);
  };
  button.type = "button"; button.className = "enlarge";
  button.addEventListener("click", () => {
    turn();
    // A figure of another size has another place on the page. Its button is at its top.
    const fits = figure.offsetHeight < window.innerHeight;
    figure.scrollIntoView({ block: fits ? "nearest" : "start" });
  });
  figure.prepend(button);
  turn();
  // On a narrow screen its words are too small otherwise.
  if (!narrow.matches) turn();
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
