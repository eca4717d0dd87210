// Says of a table or figure that it can be moved sideways, as long as some of it is cut.
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

document.querySelectorAll(".scroll").forEach(watchWidth);
