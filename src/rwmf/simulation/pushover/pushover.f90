!> Static curve of a case under lateral loads (pushover): the public procedure.
module rwmf_simulation_pushover_pushover
   use rwmf_core_control, only: control_t, is_cancelled
   use rwmf_core_error, only: err_input, err_interrupt, err_numerical, error_t, fail
   use rwmf_core_kinds, only: wp
   use rwmf_model_system_assembly, only: build_equation
   use rwmf_model_system_demands, only: building_of
   use rwmf_motion_ground_motion, only: motion_t
   use rwmf_problem_case, only: case_t
   use rwmf_problem_single_run, only: check_corners, check_single_run
   use rwmf_simulation_pushover_curve, only: static_curve_t
   use rwmf_simulation_pushover_curve_path, only: begin_path, move_roof, curve_path_t
   use rwmf_simulation_pushover_demand_columns, only: prepare_demands
   use rwmf_simulation_pushover_load_pattern, only: find_pattern
   use rwmf_simulation_pushover_static_scene, only: start_scene
   use rwmf_text_strings, only: real_to_text
   implicit none
   private

   public :: push_over

   !> Loads and displacements of a pushover.
   type, public :: protocol_t
      character(:), allocatable :: pattern
      !! 'first_mode', 'floors' or 'roof'
      real(wp), allocatable :: forces(:)
      !! forces on the floors from the ground up, for 'floors' only; in any unit
      real(wp), allocatable :: drifts(:)
      !! (legs) drifts of the roof at the ends of the legs [-]
      integer :: rows = 100
      !! largest number of rows per leg, without events
   end type protocol_t

contains

   !> Move the roof of a case slowly through a protocol of drifts, from rest.
   !>
   !> `&motion`, `&initial` and dampers do not matter. Fails with `err_input`, `err_interrupt`, or
   !> `err_numerical` if events repeat without end.
   subroutine push_over(case, protocol, control, curve, error)
      type(case_t), intent(in) :: case
      !! valid case whose frame has T_s
      type(protocol_t), intent(in) :: protocol
      type(control_t), intent(in) :: control
      !! cancel flag
      type(static_curve_t), intent(out) :: curve
      type(error_t), allocatable, intent(out) :: error
      type(motion_t), target :: still
      type(curve_path_t) :: path
      real(wp) :: u, spacing_of_rows
      logical :: is_complete
      integer :: i

      call check_single_run(case, error)
      if (.not. allocated(error)) call check_corners(case, 'a static curve', error)
      if (.not. allocated(error)) call check_drifts(protocol%drifts, error)
      if (allocated(error)) return
      call build_scene(case, protocol, still, path, error)
      if (allocated(error)) return
      call begin_path(path)
      u = 0
      do i = 1, size(protocol%drifts)
         spacing_of_rows = abs(protocol%drifts(i)*path%curve%height - u)/max(1, protocol%rows)
         u = protocol%drifts(i)*path%curve%height
         call move_roof(path, u, spacing_of_rows, is_complete)
         if (.not. is_complete) then
            call fail(error, err_numerical, 'the static path does not reach the drift ' &
               //trim(real_to_text(protocol%drifts(i)))//': at ' &
               //trim(real_to_text(path%curve%values(1, path%curve%n))) &
               //' branches change without end')
            return
         end if
         if (path%has_ended) exit
         if (is_cancelled(control)) then
            call fail(error, err_interrupt, 'interrupted')
            return
         end if
      end do
      curve = path%curve
   end subroutine push_over

   !> Check the drifts: finite and different from one to the next.
   subroutine check_drifts(drifts, error)
      real(wp), intent(in) :: drifts(:)
      type(error_t), allocatable, intent(out) :: error
      real(wp), parameter :: most = 1
      real(wp) :: before
      integer :: i

      if (size(drifts) == 0) call fail(error, err_input, 'drifts: must have at least one number')
      before = 0
      do i = 1, size(drifts)
         if (.not. abs(drifts(i)) <= most) then
            call fail(error, err_input, 'drifts: '//trim(real_to_text(drifts(i))) &
               //' must be between -1 and 1, displacement of the roof over its height')
            return
         else if (abs(drifts(i) - before) <= 0) then
            call fail(error, err_input, 'drifts: '//trim(real_to_text(drifts(i))) &
               //' must differ from the drift before it; the first leg begins at 0')
            return
         end if
         before = drifts(i)
      end do
   end subroutine check_drifts

   !> Set up scene and curve.
   subroutine build_scene(case, protocol, still, path, error)
      type(case_t), intent(in) :: case
      type(protocol_t), intent(in) :: protocol
      type(motion_t), intent(in), target :: still
      !! motion that is not used
      type(curve_path_t), intent(inout) :: path
      type(error_t), allocatable, intent(out) :: error

      associate (scene => path%scene, building => path%scene%building)
         call build_equation(case, still, scene%equation)
         call building_of(case, scene%equation, building)
         if (.not. building%roof_height > 0) then
            call fail(error, err_input, 'a pushover needs the height of the frame for its drift: ' &
               //'give &p_delta h_f, or floors with their heights')
            return
         end if
         call find_pattern(building, protocol%pattern, protocol%forces, scene%pattern, error)
         if (allocated(error)) return
         call start_scene(scene)
         call prepare_demands(case, scene)
         path%overturning_angle = case%model%overturning_angle
         path%curve%pattern = scene%pattern
         path%curve%weight = scene%equation%walls*building%weight
         path%curve%height = building%roof_height
      end associate
   end subroutine build_scene

end module rwmf_simulation_pushover_pushover
