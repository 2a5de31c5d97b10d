import { echarts } from "nicegui-echart";

export default {
  template: `<div></div>`,
  props: { options: Object },
  emits: ["pick"],
  mounted() {
    this.chart = echarts.init(this.$el);
    this.chart.setOption(JSON.parse(JSON.stringify(this.options))); // what Vue watches, ECharts would read slowly
    this.chart.on("click", (at) => at.componentType === "series" && this.$emit("pick", at.data));
    this.observer = new ResizeObserver(() => this.chart.resize());
    this.observer.observe(this.$el);
  },
  beforeUnmount() {
    this.observer.disconnect();
    this.chart.dispose();
  },
  methods: {
    show(options, whole) {
      this.chart.setOption(options, whole ? { notMerge: true } : { replaceMerge: ["series"] });
    },
  },
};
