!> Scenes with every effect, for the tests of reactions.
module reaction_scenes
   use rwmf_core_error, only: error_t
   use rwmf_core_kinds, only: wp
   use rwmf_problem_case, only: case_t, devices_t, inerter_t, link_t
   use rwmf_problem_equivalent_frame, only: set_equivalent_frame
   use rwmf_simulation_state_result, only: result_t
   use scenes, only: rwmf_scene
   implicit none
   private

   public :: scene, linked, damped, pinned, fused, with_inerter, shaken_vertically, with_tendon
   public :: hysteretic, storeys, linked_storeys, add_storeys, column
   public :: linked_pinned, pinned_with_corners, storeys_of_pinned_wall, yielding_storeys
   public :: uneven_storeys

contains

   function scene(formulation, law) result(case)
      character(*), intent(in) :: formulation
      character(*), intent(in) :: law
      type(case_t) :: case

      case = rwmf_scene(formulation, 5.0_wp, 1.0_wp, 'dop853')
      case%cable%law = law
   end function scene

   function linked(formulation) result(case)
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = scene(formulation, 'truss')
      case%link = link_t(5.0_wp)
   end function linked

   function damped() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      case%damper = devices_t(c=[2.0_wp, 2.0_wp])
   end function damped

   function pinned() result(case)
      type(case_t) :: case

      case = scene('exact', 'linear')
      deallocate (case%cable)
      case%wall%base = 'pinned'
   end function pinned

   function linked_pinned() result(case)
      type(case_t) :: case

      case = pinned()
      case%link = link_t(5.0_wp)
   end function linked_pinned

   !> Scene of a hinged wall with all devices under both corners.
   function pinned_with_corners() result(case)
      type(case_t) :: case

      case = pinned()
      case%damper = devices_t(c=[2.0_wp, 2.0_wp])
      case%fuse = devices_t(eta_y=[0.4_wp, 0.4_wp], stroke_y=[0.002_wp, 0.002_wp], &
         hardening=[0.02_wp, 0.02_wp])
      case%inerter = inerter_t(1.5_wp)
   end function pinned_with_corners

   !> Scene with fuses that yield far below the rotation of the test.
   function fused() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      case%fuse = devices_t(eta_y=[0.4_wp, 0.4_wp], stroke_y=[0.002_wp, 0.002_wp], &
         hardening=[0.02_wp, 0.02_wp])
   end function fused

   function with_inerter() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      case%inerter = inerter_t(1.5_wp)
   end function with_inerter

   function shaken_vertically() result(case)
      type(case_t) :: case

      case = scene('exact', 'truss')
      allocate (case%upward)
      case%upward%ratio = 0.65_wp
   end function shaken_vertically

   !> Scene with a tendon that yields below the rotation of the test.
   function with_tendon(law) result(case)
      character(*), intent(in) :: law
      type(case_t) :: case

      case = scene('exact', law)
      case%cable%eta_y = [1.3_wp]
      case%cable%hardening = [0.02_wp]
   end function with_tendon

   !> Scene with a frame that yields smoothly.
   function hysteretic(formulation) result(case)
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = scene(formulation, 'linear')
      allocate (case%yielding)
      case%yielding%law%name = 'bouc_wen'
      case%yielding%u_y = 0.1_wp
      case%yielding%hardening = 0.07_wp
      case%yielding%law%exponent = 2
      case%yielding%law%beta = 0.6_wp
   end function hysteretic

   !> Scene with three unequal storeys under the roof at the wall's top.
   function storeys(coupling, formulation) result(case)
      character(*), intent(in) :: coupling
      character(*), intent(in) :: formulation
      type(case_t) :: case

      case = scene(formulation, 'linear')
      call add_storeys(case, coupling)
   end function storeys

   function linked_storeys(coupling) result(case)
      character(*), intent(in) :: coupling
      type(case_t) :: case

      case = linked('exact')
      call add_storeys(case, coupling)
   end function linked_storeys

   !> Scene of a hinged wall linked to every floor.
   function storeys_of_pinned_wall() result(case)
      type(case_t) :: case

      case = pinned()
      call add_storeys(case, 'every_floor')
   end function storeys_of_pinned_wall

   !> Scene with every floor linked; all storeys yield at the same drift, far below that of the
   !> test.
   function yielding_storeys(law) result(case)
      character(*), intent(in) :: law
      type(case_t) :: case

      case = hysteretic('exact')
      case%yielding%law%name = law
      call add_storeys(case, 'every_floor')
   end function yielding_storeys

   !> Scene with every floor linked; each storey yields independently, far below the drift of the
   !> test.
   function uneven_storeys() result(case)
      type(case_t) :: case

      case = hysteretic('exact')
      case%yielding%law%name = 'elastic_plastic'
      deallocate (case%yielding%u_y)
      case%yielding%storey_u_y = [0.02_wp, 0.05_wp, 0.01_wp]
      call add_storeys(case, 'every_floor')
   end function uneven_storeys

   subroutine add_storeys(case, coupling)
      type(case_t), intent(inout) :: case
      character(*), intent(in) :: coupling
      type(error_t), allocatable :: error

      allocate (case%frame%floors)
      case%frame%coupling = coupling
      case%frame%floors%m = [3.0_wp, 2.0_wp, 1.5_wp]
      case%frame%floors%k = [600.0_wp, 500.0_wp, 300.0_wp]
      case%frame%floors%height = [2.0_wp, 1.5_wp, 0.5_wp]
      call set_equivalent_frame(case, error)
      if (allocated(error)) error stop 'storeys of the tests'
   end subroutine add_storeys

   !> Extract a column of the history.
   function column(result, name) result(values)
      type(result_t), intent(in) :: result
      character(*), intent(in) :: name
      real(wp), allocatable :: values(:)
      integer :: i

      i = findloc(result%history%names == name, .true., dim=1)
      if (i == 0) error stop 'no such column in the tests'
      values = result%history%values(:, i)
   end function column

end module reaction_scenes
